// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <tf2_ros/buffer.h>

#include <optional>
#include <string>

#include "sextant/geometry/pose.hpp"

namespace sextant {

/// A transform at a stamp, or why there is none: never an old one, never identity.
struct TransformLookup {
  std::optional<Pose> T_target_source;
  std::string reason;  ///< names both frames
};

/// Does not wait. Where target and source are one frame, the answer is identity.
TransformLookup lookUp(const tf2_ros::Buffer& buffer, const std::string& target, const std::string& source,
                       const ros::Time& stamp);

/// The newest stamp at which tf knows source in target; zero where there is none.
ros::Time newestCommonTime(const tf2_ros::Buffer& buffer, const std::string& target,
                           const std::string& source);

/// The frame above this one in the tree, by the newest that tf has heard; empty where there is none.
std::string parentFrame(const tf2_ros::Buffer& buffer, const std::string& frame);

}  // namespace sextant
