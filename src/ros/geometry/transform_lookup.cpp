// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/geometry/transform_lookup.hpp"

#include <stdexcept>

#include "sextant/ros/geometry/pose_conversions.hpp"

namespace sextant {

TransformLookup lookUp(const tf2_ros::Buffer& buffer, const std::string& target, const std::string& source,
                       const ros::Time& stamp) {
  const std::string frames =
      "no transform from '" + source + "' to '" + target + "' at the message's stamp: ";
  if (stamp.isZero()) return {std::nullopt, frames + "the stamp is zero"};
  if (source.empty()) return {std::nullopt, frames + "the message has no frame_id"};
  if (target == source) return {Pose::Identity(), ""};
  try {
    return {fromMsg(buffer.lookupTransform(target, source, stamp).transform), ""};
  } catch (const tf2::TransformException& error) {
    return {std::nullopt, frames + error.what()};
  } catch (const std::invalid_argument& error) {
    return {std::nullopt, frames + error.what()};
  }
}

ros::Time newestCommonTime(const tf2_ros::Buffer& buffer, const std::string& target,
                           const std::string& source) {
  try {
    return buffer.lookupTransform(target, source, ros::Time(0)).header.stamp;
  } catch (const tf2::TransformException&) {
    return ros::Time();
  }
}

std::string parentFrame(const tf2_ros::Buffer& buffer, const std::string& frame) {
  std::string parent;
  return buffer._getParent(frame, ros::Time(0), parent) ? parent : "";
}

}  // namespace sextant
