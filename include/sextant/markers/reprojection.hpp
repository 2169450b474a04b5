// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// An observation of a mapped marker by a camera that is mounted on a base.
struct MarkerObservation {
  const CameraModel* camera;  ///< camera of the observation; not owned
  Pose T_camera_base;         ///< pose of the base in the camera frame
  Pose T_map_marker;          ///< pose of the marker in the map
  double size;                ///< edge length, metres
  Corners corners;            ///< pixels
  std::array<double, 4> sigmas{0.3, 0.3, 0.3,
                               0.3};           ///< standard deviation of each corner's coordinates, pixels
  Matrix6d map_covariance = Matrix6d::Zero();  ///< of T_map_marker: position, rotation in the map's axes
};

/// A parametrization of pose changes by (translation, rotation about the centre of the markers). Far from the
/// markers the cost is flat along an arc about them, which couples position and rotation of the base
/// strongly.
class Pivot {
 public:
  /// Centre of the observed markers.
  explicit Pivot(const std::vector<MarkerObservation>& observations);

  const Eigen::Vector3d& centre() const { return centre_; }  ///< mean position of the markers, map
  /// Returns the pose translated by step.head<3>(), then rotated by expSO3(step.tail<3>()) about the centre.
  Pose moved(const Pose& T_map_base, const Vector6d& step) const;
  /// Returns the Jacobian of (position, rotation) with respect to the step, at step = 0.
  Matrix6d jacobian(const Pose& T_map_base) const;

 private:
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();  // map frame
};

/// Prior of a ground robot: the base is on the plane z = 0 of the map, with zero roll and pitch.
struct FloorPrior {
  double height_sigma;  ///< standard deviation of z, metres
  double tilt_sigma;    ///< standard deviation of roll and of pitch, radians
};

/// Robust loss and prior of the reprojection cost.
struct ReprojectionParams {
  double robust_width = 1e9;  ///< width of the Huber loss of a marker's residual norm, standard deviations
  std::optional<FloorPrior> floor;  ///< prior of the pose
};

/// A minimum of the reprojection cost.
struct ReprojectionFit {
  Pose T_map_base;  ///< pose of the base in the map
  double cost;      ///< sum of the Huber loss of squaredMahalanobis() over the markers, plus the prior
  double rms;       ///< RMS residual over all coordinates, weighted by 1 / sigma^2, pixels
  Matrix6d
      information;  ///< inverse covariance of (position, rotation) in the map's axes, without robust weights
};

/// Returns the squared Mahalanobis distance r' S^-1 r of a marker's eight residuals r. S is the corner noise
/// plus the uncertainty of the marker's pose in the map, J map_covariance J'. Chi-square with 8 degrees of
/// freedom at the true pose; infinite if a corner does not project into the image plane.
double squaredMahalanobis(const MarkerObservation& observation, const Pose& T_map_base);

/// Returns the squared Mahalanobis distance of a pose from the prior: 3 degrees of freedom.
double squaredMahalanobis(const FloorPrior& floor, const Pose& T_map_base);

/// Residuals of a marker's eight corner coordinates (projection minus observation, pixels) at a pose, and
/// their derivatives.
struct MarkerLinearization {
  Eigen::Matrix<double, 8, 1> residual;   ///< pixels
  Eigen::Matrix<double, 8, 6> by_base;    ///< with respect to the base's position, rotation in the map's axes
  Eigen::Matrix<double, 8, 6> by_marker;  ///< the same of the marker
  Eigen::Matrix<double, 8, 1> by_size;    ///< with respect to the logarithm of the marker's size
  Eigen::Matrix<double, 8, 8> covariance;  ///< corner noise and map_covariance, pixels^2
};

/// Linearizes the projection of a marker; nothing if a corner does not project into the image plane.
std::optional<MarkerLinearization> linearizedMarker(const MarkerObservation& observation,
                                                    const Pose& T_map_base);

/// Quadratic model of the reprojection cost at a pose: cost + 2 g' xi + xi' H xi at perturbed(pose, xi).
struct ReprojectionModel {
  Matrix6d H = Matrix6d::Zero();            ///< Gauss-Newton Hessian with the robust weights
  Matrix6d information = Matrix6d::Zero();  ///< the same without the robust weights
  Vector6d g = Vector6d::Zero();            ///< half the gradient
  double cost = 0.0;                        ///< as ReprojectionFit::cost
  double squares = 0.0;  ///< sum of squared residuals over the variance of the corner noise alone
};

/// Linearizes the reprojection cost at a pose.
ReprojectionModel reprojectionModel(const std::vector<MarkerObservation>& observations,
                                    const Pose& T_map_base, const ReprojectionParams& params);

/// Minimizes the robust reprojection cost by Levenberg-Marquardt with steps of Pivot. Returns nothing if the
/// observations do not determine the pose at the minimum.
std::optional<ReprojectionFit> minimizeReprojection(const std::vector<MarkerObservation>& observations,
                                                    const Pose& start, const ReprojectionParams& params);

}  // namespace sextant
