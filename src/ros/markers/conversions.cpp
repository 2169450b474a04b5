// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/markers/conversions.hpp"

#include <algorithm>
#include <stdexcept>

#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

Pose pose(const Eigen::Vector3d& translation, const Eigen::Quaterniond& q) {
  if (!translation.allFinite()) throw std::invalid_argument("the position has a number that is not finite");
  if (!(std::abs(q.norm() - 1.0) < 0.01))
    throw std::invalid_argument("the orientation is no unit quaternion");
  Pose result = Pose::Identity();
  result.linear() = q.normalized().toRotationMatrix();
  result.translation() = translation;
  return result;
}

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
  return pose({msg.position.x, msg.position.y, msg.position.z}, Eigen::Quaterniond(q.w, q.x, q.y, q.z));
}

Pose fromMsg(const geometry_msgs::Transform& msg) {
  const auto& q = msg.rotation;
  return pose({msg.translation.x, msg.translation.y, msg.translation.z},
              Eigen::Quaterniond(q.w, q.x, q.y, q.z));
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

Marker toMsg(const Detection& detection, double size, const std::optional<PlanarPoses>& poses,
             const std::optional<Matrix6d>& covariance) {
  Marker msg;
  msg.family = detection.key.family;
  msg.id = detection.key.id;
  for (int i = 0; i < 8; ++i) msg.corners[i] = detection.corners[i / 2][i % 2];
  std::copy(detection.corner_sigmas.begin(), detection.corner_sigmas.end(), msg.corner_sigmas.begin());
  msg.hamming = detection.hamming;
  msg.decision_margin = detection.decision_margin;
  msg.alternative_reprojection_error = -1;
  if (!poses) return msg;
  msg.size = size;
  msg.pose = toPoseWithCovarianceMsg(poses->best.T_camera_marker, covariance.value_or(Matrix6d::Zero()));
  msg.reprojection_error = poses->best.reprojection_error;
  if (!poses->alternative) return msg;
  msg.alternative_pose = toPoseMsg(poses->alternative->T_camera_marker);
  msg.alternative_reprojection_error = poses->alternative->reprojection_error;
  return msg;
}

Detection fromMsg(const Marker& msg) {
  Detection detection;
  detection.key = {canonicalFamily(msg.family), msg.id};
  for (int i = 0; i < 8; ++i) detection.corners[i / 2][i % 2] = msg.corners[i];
  for (const auto& corner : detection.corners)
    if (!corner.allFinite())
      throw std::invalid_argument("marker " + std::to_string(msg.id) + ": a corner is not finite");
  // Nought is what a message has when nobody filled it in, and no corner is exact.
  for (int i = 0; i < 4; ++i)
    detection.corner_sigmas[i] = msg.corner_sigmas[i] > 0 ? msg.corner_sigmas[i] : -1;
  detection.hamming = msg.hamming;
  detection.decision_margin = msg.decision_margin;
  return detection;
}

MarkerMapEntry toMsg(const MappedMarker& marker) {
  MarkerMapEntry msg;
  msg.family = marker.key.family;
  msg.id = marker.key.id;
  msg.size = marker.size;
  msg.name = marker.name;
  msg.pose = toPoseWithCovarianceMsg(marker.T_map_marker, marker.covariance);
  return msg;
}

MarkerMap fromMsg(const MarkerMapEntries& msg) {
  if (msg.header.frame_id.empty()) throw std::invalid_argument("the map's header names no frame");
  MarkerMap map(msg.header.frame_id);
  for (const MarkerMapEntry& entry : msg.markers)
    map.add({{entry.family, entry.id},
             entry.size,
             entry.name,
             fromMsg(entry.pose.pose),
             fromMsg(entry.pose.covariance)});
  return map;
}

}  // namespace sextant
