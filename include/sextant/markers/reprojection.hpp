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

/// A marker of known place seen by a camera that is mounted on a base.
struct MarkerSighting {
  const CameraModel* camera;  ///< not owned
  Pose T_camera_base;
  Pose T_map_marker;
  double size;                                       ///< edge length, metres
  Corners corners;                                   ///< pixels
  std::array<double, 4> sigmas{0.3, 0.3, 0.3, 0.3};  ///< noise of each corner's coordinates, pixels
  Matrix6d map_covariance = Matrix6d::Zero();  ///< of T_map_marker: position, rotation in the map's axes
};

/// Steps (shift, rotation) that turn about the centre of the markers instead of the base's origin: far from
/// its markers a base moves on an arc about them, along which the cost is flat and (p, r) are strongly
/// coupled.
class Pivot {
 public:
  explicit Pivot(const std::vector<MarkerSighting>& sightings);

  const Eigen::Vector3d& centre() const { return centre_; }
  /// The pose turned by Exp(step.tail<3>()) about the centre after a shift by step.head<3>().
  Pose moved(const Pose& T_map_base, const Vector6d& step) const;
  /// d (position, rotation) / d step at step = 0.
  Matrix6d jacobian(const Pose& T_map_base) const;

 private:
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();  // map frame
};

/// Ground robots: the base stands on the map's plane z = 0.
struct FloorPrior {
  double height_sigma;  ///< metres
  double tilt_sigma;    ///< of roll and of pitch, radians
};

struct ReprojectionParams {
  double robust_width = 1e9;  ///< Huber: a marker whose residual is longer than this many sigma counts less
  std::optional<FloorPrior> floor;
};

struct ReprojectionFit {
  Pose T_map_base;
  double cost;           ///< sum of rho(r' S^-1 r) over the markers, and the prior's
  double rms;            ///< over all coordinates, weighted by 1 / sigma^2, pixels
  Matrix6d information;  ///< of (position, rotation) in the map's axes, without the robust weights
};

/// r' S^-1 r of a marker's eight residuals, S being the noise of its corners and what its place in the map
/// adds (J map_covariance J'); chi-square with 8 degrees of freedom where the pose is true. A marker that the
/// lens does not reach from there is infinitely far off.
double squaredMahalanobis(const MarkerSighting& sighting, const Pose& T_map_base);

/// r' r / sigma^2 of what the floor says of a pose: 3 degrees of freedom.
double squaredMahalanobis(const FloorPrior& floor, const Pose& T_map_base);

/// The quadratic model of the reprojection cost at a pose: cost + 2 g' xi + xi' H xi for the pose perturbed
/// by xi.
struct ReprojectionModel {
  Matrix6d H = Matrix6d::Zero();            ///< with the robust weights
  Matrix6d information = Matrix6d::Zero();  ///< without
  Vector6d g = Vector6d::Zero();
  double cost = 0.0;
  double squares = 0.0;  ///< of the residuals over their corner's deviation, without what the map adds to it
};

ReprojectionModel reprojectionModel(const std::vector<MarkerSighting>& sightings, const Pose& T_map_base,
                                    const ReprojectionParams& params);

/// The pose that minimizes the robust reprojection cost, by Levenberg-Marquardt over six parameters (p + dp,
/// Exp(dr) R). Nothing where the start or the markers leave the pose undetermined.
std::optional<ReprojectionFit> minimizeReprojection(const std::vector<MarkerSighting>& sightings,
                                                    const Pose& start, const ReprojectionParams& params);

}  // namespace sextant
