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

/// Whether a marker was detected more than once in a view, so that at least one detection is wrong.
bool isRepeated(const MarkerView& view, const MarkerKey& key);

/// Returns the observation of a mapped marker: its detection combined with its pose in the map.
/// @param view must outlive the result
/// @param corner_sigma LocatorParams::corner_sigma, pixels
MarkerObservation mappedObservation(const MarkerView& view, const Detection& detection,
                                    const MappedMarker& marker, double corner_sigma);

/// Appends to `initial_poses` the base pose from each planar solution of a marker's pose.
/// @param poses solutions of T_camera_marker
/// @param observation index of the marker's observation, see InitialPose
void addInitialPoses(const MarkerView& view, const MappedMarker& marker, const PlanarPoses& poses,
                     size_t observation, std::vector<InitialPose>& initial_poses);

}  // namespace sextant
