// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>

#include <string>

#include "sextant/geometry/pose.hpp"

namespace sextant {

/// Broadcasts the transform from the map to a frame: not if the frame has another parent already, and only
/// with increasing stamps.
class MapTransform {
 public:
  /// Keeps a reference to the buffer.
  explicit MapTransform(const tf2_ros::Buffer& buffer) : buffer_(buffer) {}

  /// Broadcasts the transform.
  /// @return the reason, with both frames, if it cannot be sent; empty if it was sent or the stamp is not
  /// later
  std::string send(const std::string& map_frame, const std::string& child, const ros::Time& stamp,
                   const Pose& T_map_child);

  /// Allows earlier stamps again, after a jump back in time.
  void reset() { last_stamp_ = ros::Time(); }

 private:
  const tf2_ros::Buffer& buffer_;
  std::string parent_;  // the map frame sent last: the map's frame may change
  ros::Time last_stamp_;
  tf2_ros::TransformBroadcaster broadcaster_;
};

}  // namespace sextant
