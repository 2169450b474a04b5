// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/keyframes.hpp"

#include <map>
#include <utility>

namespace sextant {
namespace {

constexpr double kMoved = 2.0;  // pixels

// Centres of the markers in the images of each camera.
using Sights = std::map<std::pair<size_t, MarkerKey>, Eigen::Vector2d>;

Sights sightsOf(const RecordedInstant& instant) {
  Sights sights;
  for (const MarkerView& view : instant.views)
    for (const Detection& detection : view.detections)
      sights[{view.camera_index, detection.key}] = centre(detection.corners);
  return sights;
}

bool isNew(const Sights& sights, const Sights& last) {
  for (const auto& [marker, centre] : sights) {
    const auto before = last.find(marker);
    if (before == last.end() || (centre - before->second).norm() >= kMoved) return true;
  }
  return sights.empty();
}

}  // namespace

std::vector<size_t> keyframes(const MarkerRecording& recording) {
  std::vector<size_t> found;
  Sights last;
  for (size_t i = 0; i < recording.size(); ++i) {
    if (i > 0 && recording[i].drive != recording[i - 1].drive) last.clear();
    const Sights sights = sightsOf(recording[i]);
    const bool gap =
        i > 0 && recording[i].T_odom_base.has_value() != recording[i - 1].T_odom_base.has_value();
    if (!gap && !isNew(sights, last)) continue;
    found.push_back(i);
    for (const auto& [marker, centre] : sights) last[marker] = centre;
  }
  return found;
}

}  // namespace sextant
