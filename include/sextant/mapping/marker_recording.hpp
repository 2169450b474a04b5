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

/// The detections of a robot's cameras at one instant.
struct RecordedInstant {
  std::vector<MarkerView> views;    ///< at most one per camera
  std::optional<Pose> T_odom_base;  ///< odometry at that instant
  int drive = 0;                    ///< index of the drive; odometry of different drives is not related
};

/// Instants in order of time, one drive after another.
using MarkerRecording = std::vector<RecordedInstant>;

/// Indices of a detection in a recording.
struct RecordedObservation {
  size_t instant;    ///< index in the recording
  size_t view;       ///< index within the instant
  size_t detection;  ///< index within the view
};

/// The detection of an observation. @throws std::out_of_range for an invalid index
inline const Detection& detectionOf(const MarkerRecording& recording,
                                    const RecordedObservation& observation) {
  return recording.at(observation.instant).views.at(observation.view).detections.at(observation.detection);
}

/// Pose of the base at each instant of a recording; nothing if it is unknown.
using BasePath = std::vector<std::optional<Pose>>;

}  // namespace sextant
