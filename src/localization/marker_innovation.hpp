// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sextant/localization/marker_locator.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// Computes the innovation of a marker, compared with the pose that the other markers determine.
/// @param T_camera_marker pose of the marker, computed from its corners alone
/// @param pose from all markers used, perhaps with this one
/// @param used whether the marker contributed to the pose
/// @return nothing if the other markers do not determine a pose
std::optional<MarkerInnovation> markerInnovation(const MarkerObservation& observation,
                                                 const Pose& T_camera_marker, const PoseHypothesis& pose,
                                                 bool used);

}  // namespace sextant
