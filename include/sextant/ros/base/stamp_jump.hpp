// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

namespace sextant {

/// Whether a stamp is so much older than the newest one that a bag is played again; smaller jumps back, up to
/// 1 s, are messages out of order.
inline bool jumpsBack(const ros::Time& stamp, const ros::Time& newest) {
  return newest.toSec() - stamp.toSec() > 1.0;
}

}  // namespace sextant
