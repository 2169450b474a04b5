// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <vector>

#include "sextant/mapping/map_adjustment.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/mapping/recorded_path.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

/// A map extended by growMap().
struct GrownMap {
  MapEstimate estimate;  ///< covariances accumulated along the chain of markers, without loop closures
  /// Connected, but two poses explain their observations, or none explains enough of them.
  std::set<MarkerKey> ambiguous;
};

/// Adds the markers of a recording to a map in rings: locates the base at every instant from the markers of
/// the map, then adds those observed from known poses with an unambiguous pose. Markers without a connection
/// to the map are not added.
/// @param sizes of the markers to add
/// @param without markers that are not added
GrownMap growMap(const MarkerRecording& recording, const MarkerSizes& sizes, const MarkerMap& start,
                 const PathParams& params, const std::set<MarkerKey>& without = {});

/// The observations of every marker of a recording, without detections repeated within an image.
std::map<MarkerKey, std::vector<RecordedObservation>> observationsByMarker(const MarkerRecording& recording);

}  // namespace sextant
