// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sextant/localization/marker_locator.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/marker_pose.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// Whether a marker is more than once in a view: one of them must be wrong.
bool isRepeated(const MarkerView& view, const MarkerKey& key);

/// A detection of a mapped marker. @param view outlives what is returned
MarkerSighting mappedSighting(const MarkerView& view, const Detection& detection, const MappedMarker& marker,
                              double corner_sigma);

/// The base poses that both solutions of a marker give. @param sighting its index
void addStarts(const MarkerView& view, const MappedMarker& marker, const PlanarPoses& poses, size_t sighting,
               std::vector<PoseStart>& starts);

}  // namespace sextant
