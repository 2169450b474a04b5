// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sextant/mapping/marker_recording.hpp"
#include "sextant/mapping/recorded_path.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Sightings of a marker that agree with one another, but not with its place in the map: it was moved, or
/// there are two prints of it.
struct SecondPlace {
  MarkerKey key;
  Pose T_map_marker;                 ///< the other place
  size_t images;                     ///< that say so
  std::vector<MarkerKey> witnesses;  ///< other markers by which those images were located
};

/// The markers of a map that are seen elsewhere, by the base as it is located without them. Where two markers
/// contradict each other, both are told: the one that more others witness against comes first.
/// @param explained poses of instants at which no marker is seen elsewhere; empty at all others
std::vector<SecondPlace> secondPlaces(const MarkerRecording& recording, const MarkerMap& map,
                                      const std::vector<InstantHypotheses>& explained,
                                      const PathParams& params);

}  // namespace sextant
