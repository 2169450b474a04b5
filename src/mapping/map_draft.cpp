// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_draft.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "known_markers.hpp"
#include "map_frame.hpp"
#include "sextant/mapping/map_adjustment.hpp"
#include "sextant/mapping/map_growth.hpp"
#include "sextant/mapping/marker_placement.hpp"

namespace sextant {
namespace {

constexpr int kRobustRounds = 3;
constexpr size_t kMaxSuspects = 5;
constexpr double kSameBranch = 0.1;  // radians

bool areClose(const Pose& a, const Pose& b) {
  return logSO3(a.linear().transpose() * b.linear()).norm() < kSameBranch;
}

size_t imagesOf(const std::vector<SecondPlace>& places) {
  size_t images = 0;
  for (const SecondPlace& place : places) images += place.images;
  return images;
}

}  // namespace

MapDraft::MapDraft(MarkerRecording recording, const MarkerSizes& sizes, const MarkerMap& known,
                   const MappingParams& params)
    : fit(std::move(recording), params.corner_sigma, params.gate),
      known(known),
      sizes_(&sizes),
      params_(&params),
      frameless_(known.markers().empty()) {
  if (params.floor_height_sigma > 0) floor_ = FloorPrior{params.floor_height_sigma, params.floor_tilt_sigma};
}

void MapDraft::make() {
  draft();
  findContradictions();
  while (leaveOutWhatIsTwice()) continue;
}

void MapDraft::draft() {
  fit.begin(twice);
  grow();
  for (int round = 0; round < kRobustRounds; ++round) {
    adjust(useful(fit.placed()), params_->robust_width);
    if (params_->estimate_noise) fit.measureNoise(useful(fit.placed()));
    if (!mendBranches()) break;
  }
}

void MapDraft::grow() {
  if (frameless_) known = firstMarker(fit.recording(), *sizes_, twice);
  held = loosenedKnown(known);
  GrownMap grown = growMap(fit.recording(), *sizes_, held, path(frameless_ ? std::nullopt : floor_), twice);
  fit.estimate = std::move(grown.estimate);
  ambiguous = std::move(grown.ambiguous);
  if (frameless_ && floor_) held = known = putOnFloor(known.markers().begin()->first, fit.estimate);
  if (useful(fit.placed()).empty())
    throw std::runtime_error(
        "no image connects two markers, of which one is known: are the known markers those of the "
        "recording, with the right family and size?");
}

// A marker that is in two places spoils those around it. Which of those that contradict each other it is
// shows when each of them is left out: the rest must agree. Whether there was one.
bool MapDraft::leaveOutWhatIsTwice() {
  auto least = std::make_pair(imagesOf(second_places) / 2 + 1, size_t{0});
  std::optional<MapDraft> best;
  for (const MarkerKey& key : suspects()) {
    MapDraft without = *this;
    if (!without.draftWithout(key)) continue;
    const auto rest = std::make_pair(imagesOf(without.second_places), without.fit.unexplained());
    if (!(rest < least)) continue;
    least = rest;
    best.emplace(std::move(without));
  }
  if (best) *this = std::move(*best);
  return best.has_value();
}

// Whether anything is left.
bool MapDraft::draftWithout(const MarkerKey& key) {
  twice.insert(key);
  try {
    draft();
  } catch (const std::runtime_error&) {
    return false;
  }
  findContradictions();
  return true;
}

void MapDraft::findContradictions() {
  second_places = secondPlaces(fit.recording(), fit.estimate.map, fit.explained(), path(floor_));
}

std::vector<MarkerKey> MapDraft::suspects() const {
  std::vector<MarkerKey> all;
  const auto add = [&](const MarkerKey& key) {
    const bool told = !frameless_ && known.find(key);
    if (!told && std::find(all.begin(), all.end(), key) == all.end()) all.push_back(key);
  };
  for (const SecondPlace& place : second_places) add(place.key);
  for (const SecondPlace& place : second_places)
    for (const MarkerKey& key : place.witnesses) add(key);
  if (all.size() > kMaxSuspects) all.resize(kMaxSuspects);
  return all;
}

PathParams MapDraft::path(const std::optional<FloorPrior>& floor) const {
  return {params_->corner_sigma,
          {params_->robust_width, params_->gate, floor},
          params_->odometry,
          params_->decided};
}

AdjustmentParams MapDraft::adjustment(double robust_width) const {
  return {params_->corner_sigma, robust_width,    correlated_images, floor_,
          params_->odometry,     params_->threads};
}

// An instant with one marker says nothing of the map, unless it is bound to others or to the floor.
std::vector<RecordedSighting> MapDraft::useful(const std::vector<RecordedSighting>& all) const {
  std::map<size_t, int> markers;
  for (const RecordedSighting& each : all) ++markers[each.instant];
  std::vector<RecordedSighting> some;
  for (const RecordedSighting& each : all)
    if (markers[each.instant] > 1 || fit.recording()[each.instant].T_odom_base || floor_)
      some.push_back(each);
  return some;
}

void MapDraft::adjust(const std::vector<RecordedSighting>& used, double robust_width) {
  if (used.empty()) return;
  const auto found = adjustMap(fit.recording(), used, held, fit.estimate, adjustment(robust_width));
  if (!found)
    throw std::runtime_error("the adjustment of the map found no minimum: what was seen contradicts itself");
  fit.estimate = *found;
}

void MapDraft::locateOthers(const std::vector<RecordedSighting>& used) {
  const auto adjusted = fit.posesOf(used);
  const auto found = locateRecording(fit.recording(), fit.estimate.map, path(floor_), adjusted);
  for (size_t i = 0; i < found.size(); ++i) {
    if (!adjusted[i].empty()) continue;
    fit.estimate.T_map_base[i].reset();
    mend(fit.estimate.T_map_base[i], found[i]);
  }
}

// Markers and instants that the adjusted map puts elsewhere: wrong branches of their ambiguity.
bool MapDraft::mendBranches() {
  const auto found = locateRecording(fit.recording(), fit.estimate.map, path(floor_), fit.explained());
  bool any = false;
  for (size_t i = 0; i < found.size(); ++i) any |= mend(fit.estimate.T_map_base[i], found[i]);
  for (const auto& entry : fit.sightings()) any |= mendMarker(entry.first, entry.second, found);
  return any;
}

bool MapDraft::mend(std::optional<Pose>& pose, const InstantHypotheses& found) const {
  if (!isUsable(found, params_->decided) || (pose && areClose(*pose, found[0].T_map_base))) return false;
  pose = found[0].T_map_base;
  return true;
}

bool MapDraft::mendMarker(const MarkerKey& key, const std::vector<RecordedSighting>& sightings,
                          const std::vector<InstantHypotheses>& bases) {
  const MappedMarker *marker = fit.estimate.map.find(key), *holding = held.find(key);
  const bool doubtful = std::any_of(sightings.begin(), sightings.end(), [&](const RecordedSighting& each) {
    return marker && fit.estimate.T_map_base[each.instant] && !fit.fits(each);
  });
  if (!doubtful || (holding && holding->covariance.isZero(0.0))) return false;
  const auto places = placeMarker(fit.recording(), sightings, bases, marker->size, path(floor_));
  if (places.empty() || places[0].weight < params_->decided ||
      areClose(marker->T_map_marker, places[0].T_map_marker))
    return false;
  MappedMarker moved = *marker;
  moved.T_map_marker = places[0].T_map_marker;
  fit.estimate.map.set(moved);
  return true;
}

}  // namespace sextant
