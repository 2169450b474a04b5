// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/marker_watch.hpp"

#include <cmath>

namespace sextant {
namespace {

constexpr double kFade = 0.98;    // an image: 50 of them are remembered
constexpr double kEnough = 10.0;  // images left out, of late

}  // namespace

// The depth of a marker is uncertain by its squared distance: near images tell where it stands.
void MarkerWatch::add(const LocatedPose& pose, const MarkerMap& map) {
  if (pose.used().size() < 2) return;  // one marker's word against another's
  for (const LocatedMarker& marker : pose.markers) {
    const MappedMarker* mapped = map.find(marker.key);
    if (!mapped) continue;
    Seen& seen = seen_[marker.key];
    seen.images = kFade * seen.images + 1;
    seen.left_out = kFade * seen.left_out + (marker.used ? 0 : 1);
    if (marker.used) continue;
    const double weight = 1 / std::pow(marker.distance, 4);
    ++seen.total_left_out;
    seen.weight = kFade * seen.weight + weight;
    seen.offset = kFade * seen.offset + weight * (marker.p_map - mapped->T_map_marker.translation());
  }
}

std::vector<MovedMarker> MarkerWatch::moved() const {
  std::vector<MovedMarker> all;
  for (const auto& [key, seen] : seen_)
    if (seen.left_out >= kEnough && seen.left_out > 0.5 * seen.images)
      all.push_back({key, seen.offset / seen.weight, seen.total_left_out});
  return all;
}

}  // namespace sextant
