// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/geometry/map_transform.hpp"

#include "sextant/ros/geometry/pose_conversions.hpp"
#include "sextant/ros/geometry/transform_lookup.hpp"

namespace sextant {

std::string MapTransform::send(const std::string& map_frame, const std::string& child, const ros::Time& stamp,
                               const Pose& T_map_child) {
  if (child == map_frame) return "'" + child + "' is the frame of the map";
  if (stamp <= last_stamp_) return "";
  const std::string parent = parentFrame(buffer_, child);
  if (!parent.empty() && parent != map_frame && parent != parent_)
    return "'" + child + "' already has the parent '" + parent + "': a transform from '" + map_frame +
           "' would break the tree and is not sent";
  last_stamp_ = stamp;
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = parent_ = map_frame;
  transform.child_frame_id = child;
  transform.transform = toTransformMsg(T_map_child);
  broadcaster_.sendTransform(transform);
  return "";
}

}  // namespace sextant
