// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sextant/Marker.h"
#include "sextant/MarkerMapEntries.h"
#include "sextant/markers/marker.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/marker_pose.hpp"
#include "sextant/ros/geometry/pose_conversions.hpp"

namespace sextant {

/// Converts a detection with its poses, if they are known. @param size edge length, metres
Marker toMsg(const Detection& detection, double size, const std::optional<PlanarPoses>& poses,
             const std::optional<Matrix6d>& covariance);
/// @throws std::invalid_argument for an unknown family or corners that are not finite
Detection fromMsg(const Marker& marker);

MarkerMapEntry toMsg(const MappedMarker& marker);
/// @throws std::invalid_argument as MarkerMap::add, and for a map without a frame
MarkerMap fromMsg(const MarkerMapEntries& map);

}  // namespace sextant
