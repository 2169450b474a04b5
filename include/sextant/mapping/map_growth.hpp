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

/// A map that grew from a few markers over those that are seen beside them.
struct GrownMap {
  MapEstimate estimate;           ///< covariances are those of the way that led there, without its loops
  std::set<MarkerKey> ambiguous;  ///< connected, but two places explain what was seen of them
};

/// Adds the markers of a recording to a map, one ring after another: locates the base at every instant from
/// the markers that are there, then places those that are seen from known poses and that only one place
/// explains. Markers that nothing connects to the map are not added.
/// @param sizes of the markers to add
/// @param without markers that are not added
GrownMap growMap(const MarkerRecording& recording, const MarkerSizes& sizes, const MarkerMap& start,
                 const PathParams& params, const std::set<MarkerKey>& without = {});

/// The sightings of every marker of a recording; those of markers that are twice in one image are left out.
std::map<MarkerKey, std::vector<RecordedSighting>> sightingsByMarker(const MarkerRecording& recording);

}  // namespace sextant
