// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/markers/marker.hpp"
#include "sextant/markers/marker_pose.hpp"

namespace sextant {

/// Edge lengths of the markers.
struct MarkerSizes {
  double size = 0.2;
  std::map<std::string, double> sizes;

  ParamList fields();
  double of(const MarkerKey& key) const;  ///< edge length of a marker, metres
};

/// A detection with its pose in the camera frame, if the corners give one.
struct ObservedMarker {
  Detection detection;                 ///< family, id and corners
  double size;                         ///< metres
  std::optional<PlanarPoses> poses;    ///< both solutions of the pose; nothing if the corners give none
  std::optional<Matrix6d> covariance;  ///< of poses->best, in the optical frame's axes
};

/// Computes the poses of all detections.
/// @param sigma standard deviation of each corner coordinate, pixels
std::vector<ObservedMarker> observeMarkers(const CameraModel& camera,
                                           const std::vector<Detection>& detections, const MarkerSizes& sizes,
                                           double sigma);

}  // namespace sextant
