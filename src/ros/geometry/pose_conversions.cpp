// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/geometry/pose_conversions.hpp"

#include <algorithm>

namespace sextant {
namespace {

// Binning merges pixels whose centres lie half a pixel inside the merged one.
double binned(double centre, double offset, double binning) {
  return (centre - offset + 0.5) / binning - 0.5;
}

}  // namespace

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

CameraCalibration fromMsg(const sensor_msgs::CameraInfo& info) {
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  const uint32_t bx = std::max(1u, info.binning_x), by = std::max(1u, info.binning_y);
  const bool whole = info.roi.width == 0 || info.roi.height == 0;
  CameraCalibration calibration;
  calibration.width = static_cast<int>((whole ? info.width : info.roi.width) / bx);
  calibration.height = static_cast<int>((whole ? info.height : info.roi.height) / by);
  calibration.distortion_model = info.distortion_model;
  calibration.D = info.D;
  calibration.K = Eigen::Map<const RowMajor3>(info.K.data());
  calibration.R = Eigen::Map<const RowMajor3>(info.R.data());
  calibration.P = Eigen::Map<const RowMajor34>(info.P.data());
  const auto adapt = [&](auto& matrix) {
    matrix.row(0) /= bx;
    matrix.row(1) /= by;
    matrix(0, 2) = binned(matrix(0, 2) * bx, whole ? 0 : info.roi.x_offset, bx);
    matrix(1, 2) = binned(matrix(1, 2) * by, whole ? 0 : info.roi.y_offset, by);
  };
  adapt(calibration.K);
  adapt(calibration.P);
  return calibration;
}

}  // namespace sextant
