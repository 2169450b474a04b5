// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_innovation.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "sextant/markers/marker_pose.hpp"

namespace sextant {
namespace {

constexpr double kLeastCondition = 1e-14;  // of the information that the other markers leave

struct Others {
  Pose T_map_base;
  Matrix6d covariance;
  double squared;  // Mahalanobis distance of the marker from it
};

// By the marker's residual r (whitened), its Jacobian J and information A = J' J, with H that of the pose:
// the others' pose has the covariance (H - A)^-1, lies at (H - A)^-1 J' r, and r' (1 - J H^-1 J')^-1 r is r'
// r + r' J (H - A)^-1 J' r. A marker that was not used is seen from the pose itself.
std::optional<Others> without(const MarkerSighting& sighting, const PoseHypothesis& pose, bool used) {
  const ReprojectionModel block = reprojectionModel({sighting}, pose.T_map_base, {});
  const Matrix6d H = pose.covariance.ldlt().solve(Matrix6d::Identity());
  const Eigen::LDLT<Matrix6d> rest(H + (used ? -1 : 1) * block.H);
  if (!rest.isPositive() || rest.rcond() < kLeastCondition) return std::nullopt;
  const Vector6d step = rest.solve(block.g);
  if (!used) return Others{pose.T_map_base, pose.covariance, block.cost - block.g.dot(step)};
  return Others{perturbed(pose.T_map_base, step), rest.solve(Matrix6d::Identity()),
                block.cost + block.g.dot(step)};
}

}  // namespace

// p = p_base + R p_marker.
std::optional<MarkerInnovation> markerInnovation(const MarkerSighting& sighting, const Pose& T_camera_marker,
                                                 const PoseHypothesis& pose, bool used) {
  const auto others = without(sighting, pose, used);
  if (!others) return std::nullopt;
  const Pose T_map_camera = others->T_map_base * sighting.T_camera_base.inverse();
  const Eigen::Vector3d p_map = T_map_camera * T_camera_marker.translation();
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << Eigen::Matrix3d::Identity(), -skew(p_map - others->T_map_base.translation());
  Eigen::Matrix3d covariance = by_pose * others->covariance * by_pose.transpose();
  const double sigma = *std::max_element(sighting.sigmas.begin(), sighting.sigmas.end());
  const auto own = markerPoseCovariance(*sighting.camera, T_camera_marker, sighting.size, sigma);
  const Eigen::Matrix3d R = T_map_camera.linear();
  if (own) covariance += R * own->topLeftCorner<3, 3>() * R.transpose();
  return MarkerInnovation{others->squared, p_map, covariance};
}

}  // namespace sextant
