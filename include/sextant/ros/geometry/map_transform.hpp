// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>

#include <string>

#include "sextant/geometry/pose.hpp"

namespace sextant {

/// The one transform that Sextant publishes, from the map to a frame: never where it would give that frame a
/// second parent, and never with a stamp that is not later than the last.
class MapTransform {
 public:
  explicit MapTransform(const tf2_ros::Buffer& buffer) : buffer_(buffer) {}

  /// @return why nothing could be sent, with both frames; empty where it was sent or is not later
  std::string send(const std::string& map_frame, const std::string& child, const ros::Time& stamp,
                   const Pose& T_map_child);

  /// After a jump back in time.
  void reset() { last_stamp_ = ros::Time(); }

 private:
  const tf2_ros::Buffer& buffer_;
  std::string parent_;  // the last that was sent: the map's frame may change, this one is ours
  ros::Time last_stamp_;
  tf2_ros::TransformBroadcaster broadcaster_;
};

}  // namespace sextant
