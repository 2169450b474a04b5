// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sextant/localization/marker_locator.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// A marker against the pose that the other markers give.
/// @param T_camera_marker where the marker is by its own corners
/// @param used whether the pose is also this marker's
/// @return nothing where the others give no pose
std::optional<MarkerInnovation> markerInnovation(const MarkerSighting& sighting, const Pose& T_camera_marker,
                                                 const PoseHypothesis& pose, bool used);

}  // namespace sextant
