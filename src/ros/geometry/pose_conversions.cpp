// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/geometry/pose_conversions.hpp"

#include <algorithm>

namespace sextant {
geometry_msgs::Pose toPoseMsg(const Pose& pose) {
  geometry_msgs::Pose msg;
  const Eigen::Quaterniond q(pose.linear());
  msg.position.x = pose.translation().x();
  msg.position.y = pose.translation().y();
  msg.position.z = pose.translation().z();
  msg.orientation.x = q.x();
  msg.orientation.y = q.y();
  msg.orientation.z = q.z();
  msg.orientation.w = q.w();
  return msg;
}

geometry_msgs::Transform toTransformMsg(const Pose& pose) {
  const geometry_msgs::Pose from = toPoseMsg(pose);
  geometry_msgs::Transform msg;
  msg.translation.x = from.position.x;
  msg.translation.y = from.position.y;
  msg.translation.z = from.position.z;
  msg.rotation = from.orientation;
  return msg;
}

geometry_msgs::PoseWithCovariance toPoseWithCovarianceMsg(const Pose& pose, const Matrix6d& covariance) {
  geometry_msgs::PoseWithCovariance msg;
  msg.pose = toPoseMsg(pose);
  std::copy(covariance.data(), covariance.data() + 36, msg.covariance.begin());
  return msg;
}

Pose fromMsg(const geometry_msgs::Pose& msg) {
  const auto& q = msg.orientation;
  return poseFromQuaternion({msg.position.x, msg.position.y, msg.position.z}, {q.w, q.x, q.y, q.z});
}

Pose fromMsg(const geometry_msgs::Transform& msg) {
  const auto& q = msg.rotation;
  return poseFromQuaternion({msg.translation.x, msg.translation.y, msg.translation.z}, {q.w, q.x, q.y, q.z});
}

Matrix6d fromMsg(const geometry_msgs::PoseWithCovariance::_covariance_type& covariance) {
  return Eigen::Map<const Matrix6d>(covariance.data());
}

}  // namespace sextant
