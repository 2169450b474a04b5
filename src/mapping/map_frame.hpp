// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>

#include "sextant/mapping/map_adjustment.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

/// A map of one marker of the recording, for one that has no known marker: the first of those that most
/// others are connected with hangs upright in the origin and looks along -y.
/// @param without markers that cannot be it
MarkerMap firstMarker(const MarkerRecording& recording, const MarkerSizes& sizes,
                      const std::set<MarkerKey>& without);

/// Turns and lifts the map of firstMarker() so that the path lies on the plane z = 0; the marker stays at x =
/// 0, y = 0 and looks along -y as seen from above.
/// @return that marker, held in x, y and yaw
MarkerMap putOnFloor(const MarkerKey& first, MapEstimate& estimate);

}  // namespace sextant
