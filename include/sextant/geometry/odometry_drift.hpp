// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sextant {

/// Variance of odometry after a distance (metres) and a turn (radians, not negative), from the deviations
/// after one metre and one radian. As in Thrun, Burgard and Fox 2005, section 5.4, but it grows in proportion
/// to both, so that many small steps are as uncertain as few large ones.
inline double driftVariance(double after_metre, double after_radian, double distance, double turn) {
  return after_metre * after_metre * distance + after_radian * after_radian * turn;
}

}  // namespace sextant
