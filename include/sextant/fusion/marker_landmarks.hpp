// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/landmarks/observation_2d.hpp"
#include "sextant/markers/marker.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Parameters of the conversion of printed markers to planar landmarks.
struct MarkerLandmarkParams {
  double heading_min_probability = 0.9999;
  double corner_sigma = 0.3;
  double tilt_sigma = 0.01;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// Heading of a marker seen from above, from the print to its reader, radians: perpendicular to the lower
/// edge, which is the normal on a wall; the normal itself if that edge is steeper than 45 degrees.
double headingOf(const Eigen::Matrix3d& R_map_marker);

/// Probability that the worse one of the two poses of a marker is the true one.
/// @param error, alternative_error reprojection errors of both poses, RMS over eight coordinates, pixels
/// @param sigma standard deviation of a corner coordinate, pixels
double alternativePoseProbability(double error, double alternative_error, double sigma);

/// Converts a detected marker to a planar observation in the robot frame. It has a heading and can initialize
/// a landmark only if the solution of its pose is unambiguous.
/// @param covariance of T_camera_marker: position, rotation in the axes of the optical frame
/// @param alternative_probability probability that the alternative pose is the true one
LabelledObservation markerObservation(const MarkerKey& key, const Pose& T_base_camera,
                                      const Pose& T_camera_marker, const Matrix6d& covariance,
                                      double alternative_probability, const MarkerLandmarkParams& params);

/// The markers of a map as planar landmarks.
struct MarkerLandmarks {
  std::vector<Landmark2D> landmarks;         ///< the markers' positions in the map
  std::vector<LandmarkLabel> labels;         ///< family and id of each
  std::vector<Eigen::Matrix3d> covariances;  ///< of (x, y, heading) of each, in the map frame
};

/// Converts a marker map to planar landmarks.
MarkerLandmarks landmarksOf(const MarkerMap& map);

}  // namespace sextant
