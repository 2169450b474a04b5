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
  double ramp_sigma = 0;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// Heading of a marker seen from above, from the print to its reader, radians: perpendicular to the lower
/// edge, which is the normal on a wall; the normal itself if that edge is steeper than 45 degrees.
double headingOf(const Eigen::Matrix3d& R_map_marker);

/// Probability that the worse one of the two poses of a marker is the true one.
/// @param error, alternative_error reprojection errors of both poses, RMS over eight coordinates, pixels
/// @param sigma standard deviation of a corner coordinate, pixels
double alternativePoseProbability(double error, double alternative_error, double sigma);

/// A detected marker.
struct SeenMarker {
  MarkerKey key;                       ///< family and id
  Pose T_camera_marker;                ///< its pose in the optical frame
  Matrix6d covariance;                 ///< position, rotation in the axes of the optical frame
  double alternative_probability = 0;  ///< that the other one of its two poses is the true one
};

/// Converts the markers of an image to planar observations in the robot frame. They have a heading and can
/// initialize landmarks only if the solution of their pose is unambiguous.
/// @param map if the robot may be on a ramp, the full poses of its markers measure the slope; or nullptr
std::vector<LabelledObservation> markerObservations(const std::vector<SeenMarker>& markers,
                                                    const Pose& T_base_camera,
                                                    const MarkerLandmarkParams& params,
                                                    const MarkerMap* map = nullptr);

/// The markers of a map as planar landmarks.
struct MarkerLandmarks {
  std::vector<Landmark2D> landmarks;         ///< the markers' positions in the map
  std::vector<LandmarkLabel> labels;         ///< family and id of each
  std::vector<Eigen::Matrix3d> covariances;  ///< of (x, y, heading) of each, in the map frame
};

/// Converts a marker map to planar landmarks.
MarkerLandmarks landmarksOf(const MarkerMap& map);

}  // namespace sextant
