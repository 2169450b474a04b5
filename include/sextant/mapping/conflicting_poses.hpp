// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sextant/mapping/marker_recording.hpp"
#include "sextant/mapping/recorded_path.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Another pose of a marker than that in the map, from observations that are consistent with each other but
/// not with the map: the marker was moved, or its id is used twice.
struct ConflictingPose {
  MarkerKey key;                     ///< family and id
  Pose T_map_marker;                 ///< the other pose
  size_t images;                     ///< number of images that support it
  std::vector<MarkerKey> witnesses;  ///< other markers from which those images were located
};

/// Finds the markers of a map with observations of another pose, with the base located from the other
/// markers. If two markers contradict each other, both are returned, the one with more witnesses first.
/// @param explained poses of instants at which most markers fit the map; empty at all others, which are
/// located without the marker in question
std::vector<ConflictingPose> conflictingPoses(const MarkerRecording& recording, const MarkerMap& map,
                                              const std::vector<InstantHypotheses>& explained,
                                              const PathParams& params);

}  // namespace sextant
