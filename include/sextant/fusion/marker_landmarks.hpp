// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/landmarks/plane_sighting.hpp"
#include "sextant/markers/marker.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// How printed markers become landmarks of the plane.
struct MarkerLandmarkParams {
  double decided = 0.9999;
  double corner_sigma = 0.3;
  double tilt_sigma = 0.01;

  ParamList fields();
};

/// From a print to who reads it, seen from above, radians: across its lower edge, which is the way of its
/// normal on a wall; where that edge is steeper than 45 degrees, the normal itself.
double headingOf(const Eigen::Matrix3d& R_map_marker);

/// Probability that the worse of a marker's two poses is right, which corners of this noise allow.
/// @param error, other_error reprojection errors of both, RMS over eight coordinates
double probabilityOfOther(double error, double other_error, double sigma);

/// A marker that a camera sees, in the plane of the robot. Its heading is told where the planar problem has
/// one answer; a landmark begins only with one.
/// @param covariance of T_camera_marker: position, rotation in the axes of the optical frame
/// @param other probability that its other pose is right
LabelledSighting markerSighting(const MarkerKey& key, const Pose& T_base_camera, const Pose& T_camera_marker,
                                const Matrix6d& covariance, double other, const MarkerLandmarkParams& params);

/// A map of markers as landmarks.
struct MarkerLandmarks {
  std::vector<PlaneLandmark> landmarks;
  std::vector<LandmarkLabel> labels;
  std::vector<Eigen::Matrix3d> covariances;  ///< of (x, y, heading) of each, map's axes
};
MarkerLandmarks landmarksOf(const MarkerMap& map);

}  // namespace sextant
