// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_innovation.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "sextant/markers/marker_pose.hpp"

namespace sextant {
namespace {

constexpr double kMinCondition = 1e-14;  // reciprocal condition number of the other markers' information

// The pose that the other markers determine.
struct PoseFromOthers {
  Pose T_map_base;
  Matrix6d covariance;
  double squared_distance;  // squared Mahalanobis distance of the marker's corners from their projection
};

// Removes a marker from the pose: with its whitened residual r, Jacobian J and information A = J' J, and
// the pose's information H, the pose from the others has the covariance (H - A)^-1 and the offset (H - A)^-1
// J' r. The squared Mahalanobis distance r' (1 - J H^-1 J')^-1 r equals r' r + r' J (H - A)^-1 J' r. For a
// marker that was not used, it is r' (1 + J H^-1 J')^-1 r.
std::optional<PoseFromOthers> withoutMarker(const MarkerObservation& observation, const PoseHypothesis& pose,
                                            bool used) {
  const ReprojectionModel marker = reprojectionModel({observation}, pose.T_map_base, {});
  const Matrix6d H = pose.covariance.ldlt().solve(Matrix6d::Identity());
  const Eigen::LDLT<Matrix6d> information(H + (used ? -1 : 1) * marker.H);
  if (!information.isPositive() || information.rcond() < kMinCondition) return std::nullopt;
  const Vector6d step = information.solve(marker.g);
  if (!used) return PoseFromOthers{pose.T_map_base, pose.covariance, marker.cost - marker.g.dot(step)};
  return PoseFromOthers{perturbed(pose.T_map_base, step), information.solve(Matrix6d::Identity()),
                        marker.cost + marker.g.dot(step)};
}

}  // namespace

// The Jacobian J of p_map = p_base + R p with respect to the pose of the base is (I, -skew(R p)).
std::optional<MarkerInnovation> markerInnovation(const MarkerObservation& observation,
                                                 const Pose& T_camera_marker, const PoseHypothesis& pose,
                                                 bool used) {
  const auto others = withoutMarker(observation, pose, used);
  if (!others) return std::nullopt;
  const Pose T_map_camera = others->T_map_base * observation.T_camera_base.inverse();
  const Eigen::Vector3d p_map = T_map_camera * T_camera_marker.translation();
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -skew(p_map - others->T_map_base.translation());
  Eigen::Matrix3d covariance = J * others->covariance * J.transpose();
  const double sigma = *std::max_element(observation.sigmas.begin(), observation.sigmas.end());
  const auto marker_covariance =
      markerPoseCovariance(*observation.camera, T_camera_marker, observation.size, sigma);
  const Eigen::Matrix3d R = T_map_camera.linear();
  if (marker_covariance) covariance += R * marker_covariance->topLeftCorner<3, 3>() * R.transpose();
  return MarkerInnovation{others->squared_distance, p_map, covariance};
}

}  // namespace sextant
