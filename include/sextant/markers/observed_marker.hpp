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

/// How large the markers are that a detector sees.
struct MarkerSizes {
  double size = 0.2;
  std::map<std::string, double> sizes;

  ParamList fields();
  double of(const MarkerKey& key) const;
};

/// A detection with its pose in the camera frame, where the corners give one.
struct ObservedMarker {
  Detection detection;
  double size;  ///< metres
  std::optional<PlanarPoses> poses;
  std::optional<Matrix6d> covariance;  ///< of poses->best, in the optical frame's axes
};

/// Poses of all detections. @param sigma noise of a corner coordinate, pixels
std::vector<ObservedMarker> observeMarkers(const CameraModel& camera,
                                           const std::vector<Detection>& detections, const MarkerSizes& sizes,
                                           double sigma);

}  // namespace sextant
