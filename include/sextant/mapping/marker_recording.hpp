// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/localization/marker_locator.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// What a robot's cameras saw at one instant of a drive.
struct RecordedInstant {
  std::vector<MarkerView> views;    ///< one a camera at most
  std::optional<Pose> T_odom_base;  ///< odometry at that instant
  int drive = 0;                    ///< instants of different drives have no odometry in common
};

/// In order of time, one drive after another.
using MarkerRecording = std::vector<RecordedInstant>;

/// A marker in an image of a recording, by indices.
struct RecordedSighting {
  size_t instant, view, detection;
};

/// The marker of a sighting. @throws std::out_of_range for an index that is not there
inline const Detection& detectionOf(const MarkerRecording& recording, const RecordedSighting& sighting) {
  return recording.at(sighting.instant).views.at(sighting.view).detections.at(sighting.detection);
}

/// Where the base was at each instant of a recording; nothing where that is not known.
using BasePath = std::vector<std::optional<Pose>>;

}  // namespace sextant
