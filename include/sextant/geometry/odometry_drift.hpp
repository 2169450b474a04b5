// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sextant {

/// Returns the variance of odometry after a distance (metres, >= 0) and a turn (radians, >= 0), from the
/// standard deviations after 1 m and after 1 rad. The model of Thrun, Burgard and Fox 2005, "Probabilistic
/// Robotics", section 5.4, except that the variance is proportional to distance and turn, so that the result
/// does not depend on the number of steps.
inline double driftVariance(double after_metre, double after_radian, double distance, double turn) {
  return after_metre * after_metre * distance + after_radian * after_radian * turn;
}

}  // namespace sextant
