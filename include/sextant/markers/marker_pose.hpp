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
  Pose T_camera_marker;             ///< pose of the marker in the camera frame
  double reprojection_error = 0.0;  ///< RMS over the eight corner coordinates, pixels
};

/// The two solutions for the pose of a square from its four corners. They fit almost equally well if the
/// camera looks at the square nearly head-on.
struct PlanarPoses {
  MarkerPose best;                        ///< solution with the smaller reprojection error
  std::optional<MarkerPose> alternative;  ///< the other solution; nothing if there is only one minimum

  /// Ratio of the reprojection errors, best over alternative, in [0, 1]; 0 without an alternative.
  double ambiguity() const;
};

/// Solves for the pose of a marker: the two solutions of the planar problem (Collins & Bartoli 2014,
/// "Infinitesimal plane-based pose estimation", OpenCV's SOLVEPNP_IPPE_SQUARE), each refined to the minimum
/// of the reprojection error with the full camera model. Returns nothing if the lens model has no ray for a
/// corner, the corners are degenerate or the marker would lie behind the camera.
/// @param size edge length, metres
std::optional<PlanarPoses> solveMarkerPose(const CameraModel& camera, const Corners& corners, double size);

/// Computes the covariance of a marker's pose (position, rotation in the axes of the optical frame; m^2,
/// rad^2): sigma^2 (J^T J)^-1, with the Jacobian J of the corners with respect to the pose. Returns nothing
/// if J is rank deficient.
/// @param size edge length, metres
/// @param sigma standard deviation of each corner coordinate, pixels
std::optional<Matrix6d> markerPoseCovariance(const CameraModel& camera, const Pose& T_camera_marker,
                                             double size, double sigma);

}  // namespace sextant
