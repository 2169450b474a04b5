// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/mapping/recorded_path.hpp"

namespace sextant {

/// One place that a marker may have.
struct MarkerPlace {
  Pose T_map_marker;
  Matrix6d covariance;            ///< position, rotation in the map's axes
  double weight;                  ///< probability among the places
  std::vector<size_t> explained;  ///< indices of the sightings that fit
  double agreement;               ///< share of those that took part and fit
};

/// Where a marker is, from images whose poses are known as far as path tells, the most probable place first.
/// Every image leaves two poses of the marker, and may leave several of the base: those are chosen on which
/// the images agree. Empty where no image that saw it has a pose.
/// @param sightings of one marker
/// @param size edge length, metres
std::vector<MarkerPlace> placeMarker(const MarkerRecording& recording,
                                     const std::vector<RecordedSighting>& sightings,
                                     const std::vector<InstantHypotheses>& path, double size,
                                     const PathParams& params);

/// Squared Mahalanobis distance of a sighting's corners from where a marker at this place would be seen, from
/// the pose of the base that fits best. Nothing where the instant has none, or the corners give no pose.
std::optional<double> distanceFromPlace(const MarkerRecording& recording, const RecordedSighting& sighting,
                                        const InstantHypotheses& bases, double size, const Pose& T_map_marker,
                                        const PathParams& params);

}  // namespace sextant
