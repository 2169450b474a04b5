// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// One local minimum of a marker's reprojection error.
struct MarkerPose {
  Pose T_camera_marker;
  double reprojection_error = 0.0;  ///< RMS over the eight corner coordinates, pixels
};

/// Both poses that explain a square's four corners; seen nearly head-on they fit almost equally well.
struct PlanarPoses {
  MarkerPose best;
  std::optional<MarkerPose> alternative;  ///< absent where both starts lead to one minimum

  /// Reprojection error of the best over that of the alternative, in [0, 1]; 0 where there is no alternative.
  double ambiguity() const;
};

/// Both solutions of the planar problem (Collins & Bartoli 2014, "Infinitesimal plane-based pose estimation",
/// OpenCV's SOLVEPNP_IPPE_SQUARE), each refined to the minimum of the reprojection error through the full
/// camera model. Nothing where a corner is out of the lens model's reach, the corners are degenerate or the
/// marker would lie behind the camera.
/// @param size edge length in metres
std::optional<PlanarPoses> solveMarkerPose(const CameraModel& camera, const Corners& corners, double size);

/// Covariance of one marker's pose (position, rotation in the axes of the optical frame) from corner noise of
/// sigma pixels a coordinate: sigma^2 (J^T J)^-1. Nothing where J is rank deficient.
std::optional<Matrix6d> markerPoseCovariance(const CameraModel& camera, const Pose& T_camera_marker,
                                             double size, double sigma);

}  // namespace sextant
