// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/mapping/recorded_path.hpp"

namespace sextant {

/// A hypothesis of the pose of a marker.
struct MarkerPlace {
  Pose T_map_marker;              ///< pose of the marker in the map
  Matrix6d covariance;            ///< position, rotation in the map's axes
  double weight;                  ///< probability among the hypotheses
  std::vector<size_t> explained;  ///< indices of the observations that fit
  double agreement;               ///< fraction of the observations used that fit
};

/// Locates a marker from images with known poses, the most probable hypothesis first. An image allows two
/// poses of the marker, and possibly several of the base; the poses on which most images agree are chosen.
/// Empty if no image of the marker has a pose.
/// @param observations of one marker
/// @param path pose hypotheses of the base at each instant
/// @param size edge length, metres
std::vector<MarkerPlace> placeMarker(const MarkerRecording& recording,
                                     const std::vector<RecordedObservation>& observations,
                                     const std::vector<InstantHypotheses>& path, double size,
                                     const PathParams& params);

/// Squared Mahalanobis distance of an observation's corners from the projection of a marker at this pose,
/// with the base pose that fits best. Returns nothing if the instant has no base pose.
std::optional<double> distanceFromPlace(const MarkerRecording& recording,
                                        const RecordedObservation& observation,
                                        const InstantHypotheses& bases, double size, const Pose& T_map_marker,
                                        const PathParams& params);

}  // namespace sextant
