// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <vector>

#include "sextant/mapping/map_adjustment.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

/// Returns a map of one marker, which defines the frame of a recording without known markers: the one with
/// the lowest family and id of the largest connected group, upright at the origin, facing along -y.
/// @param without markers that must not be used
MarkerMap firstMarker(const std::string& frame, const MarkerRecording& recording, const MarkerSizes& sizes,
                      const std::set<MarkerKey>& without);

/// The observed markers that these observations, and the odometry of their drives, connect with a map.
std::set<MarkerKey> connectedMarkers(const MarkerRecording& recording,
                                     const std::vector<RecordedObservation>& observations,
                                     const MarkerMap& map);

/// Rotates and raises a map that started from firstMarker() so that the path lies on the plane z = 0. The
/// marker stays at x = 0, y = 0 and, seen from above, faces along -y.
/// @return that marker, fixed in x, y and yaw
MarkerMap putOnFloor(const MarkerKey& first, MapEstimate& estimate);

}  // namespace sextant
