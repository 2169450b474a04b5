// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <tf2_ros/buffer.h>

#include <optional>
#include <string>

#include "sextant/geometry/pose.hpp"

namespace sextant {

/// A transform at a stamp, or the reason why there is none.
struct TransformLookup {
  std::optional<Pose> T_target_source;  ///< none: see the reason
  std::string reason;                   ///< contains both frames
};

/// Looks up a transform without waiting. The result is the identity only if target and source are equal.
TransformLookup lookUp(const tf2_ros::Buffer& buffer, const std::string& target, const std::string& source,
                       const ros::Time& stamp);

/// Returns the newest stamp at which the transform is available; zero if it never is.
ros::Time newestCommonTime(const tf2_ros::Buffer& buffer, const std::string& target,
                           const std::string& source);

/// Returns the newest known parent of a frame; empty if it has none.
std::string parentFrame(const tf2_ros::Buffer& buffer, const std::string& frame);

}  // namespace sextant
