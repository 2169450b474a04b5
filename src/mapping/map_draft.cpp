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

size_t imagesOf(const std::vector<ConflictingPose>& places) {
  size_t images = 0;
  for (const ConflictingPose& place : places) images += place.images;
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
  while (excludeInconsistent()) continue;
}

void MapDraft::draft() {
  fit.begin(inconsistent);
  grow();
  for (int round = 0; round < kRobustRounds; ++round) {
    adjust(informative(fit.placed()), params_->robust_width);
    if (params_->estimate_noise) fit.measureNoise(informative(fit.placed()));
    if (!mendBranches()) break;
  }
}

void MapDraft::grow() {
  if (frameless_) known = firstMarker(known.frame(), fit.recording(), *sizes_, inconsistent);
  held = loosenedKnown(known);
  GrownMap grown =
      growMap(fit.recording(), *sizes_, held, path(frameless_ ? std::nullopt : floor_), inconsistent);
  fit.estimate = std::move(grown.estimate);
  ambiguous = std::move(grown.ambiguous);
  if (frameless_ && floor_) held = known = putOnFloor(known.markers().begin()->first, fit.estimate);
  if (informative(fit.placed()).empty())
    throw std::runtime_error(
        "no image contains a known and another marker: check that the known markers are in the recording, "
        "with "
        "the right family and size");
}

// Whether the first conflicting pose has so many more witnesses than the others that its marker is the bad
// one.
bool MapDraft::isFirstToBlame() const {
  const auto& all = conflicting_poses;
  return !all.empty() && all[0].witnesses.size() > 1 &&
         (all.size() < 2 || all[0].witnesses.size() >= 2 * all[1].witnesses.size());
}

// A marker with two poses also corrupts those around it. Tries to exclude each of the contradicting markers,
// so that the rest is consistent. Returns whether one was excluded.
bool MapDraft::excludeInconsistent() {
  const bool first_to_blame = isFirstToBlame();
  auto least = std::make_pair(imagesOf(conflicting_poses) / 2 + 1, size_t{0});
  std::optional<MapDraft> best;
  for (const MarkerKey& key : suspects()) {
    MapDraft without = *this;
    if (!without.draftWithout(key)) continue;
    const auto rest = std::make_pair(imagesOf(without.conflicting_poses), without.fit.unexplained());
    if (!(rest < least)) continue;
    least = rest;
    best.emplace(std::move(without));
    if (first_to_blame && rest.first == 0) break;
  }
  if (best) *this = std::move(*best);
  return best.has_value();
}

// Returns whether any marker is left.
bool MapDraft::draftWithout(const MarkerKey& key) {
  inconsistent.insert(key);
  try {
    draft();
  } catch (const std::runtime_error&) {
    return false;
  }
  findContradictions();
  return true;
}

void MapDraft::findContradictions() {
  conflicting_poses = conflictingPoses(fit.recording(), fit.estimate.map, fit.explained(), path(floor_));
}

std::vector<MarkerKey> MapDraft::suspects() const {
  std::vector<MarkerKey> all;
  const auto add = [&](const MarkerKey& key) {
    const bool is_known = !frameless_ && known.find(key);
    if (!is_known && std::find(all.begin(), all.end(), key) == all.end()) all.push_back(key);
  };
  for (const ConflictingPose& place : conflicting_poses) add(place.key);
  for (const ConflictingPose& place : conflicting_poses)
    for (const MarkerKey& key : place.witnesses) add(key);
  if (all.size() > kMaxSuspects) all.resize(kMaxSuspects);
  return all;
}

PathParams MapDraft::path(const std::optional<FloorPrior>& floor) const {
  return {params_->corner_sigma,
          {params_->robust_width, params_->gate, floor},
          params_->odometry,
          params_->min_probability};
}

// As long as there may be wrong observations, the calibrations hold: errors of the lens would explain some.
AdjustmentParams MapDraft::adjustment(double robust_width) const {
  const double lens_sigma = robust_width > 0 ? 0 : params_->lens_sigma;
  return {params_->corner_sigma, robust_width,    lens_sigma, correlated_images, floor_,
          params_->odometry,     params_->threads};
}

std::vector<RecordedObservation> MapDraft::informative(const std::vector<RecordedObservation>& all) const {
  std::map<size_t, int> markers;
  for (const RecordedObservation& each : all) ++markers[each.instant];
  std::vector<RecordedObservation> some;
  for (const RecordedObservation& each : all)
    if (markers[each.instant] > 1 || fit.recording()[each.instant].T_odom_base || floor_)
      some.push_back(each);
  return some;
}

void MapDraft::adjust(const std::vector<RecordedObservation>& used, double robust_width) {
  if (used.empty()) return;
  auto found = adjustMap(fit.measured(), used, held, fit.estimate, adjustment(robust_width));
  if (!found)
    throw std::runtime_error("the adjustment of the map found no minimum: the observations are inconsistent");
  fit.accept(std::move(*found));
}

void MapDraft::locateRemainingInstants(const std::vector<RecordedObservation>& used) {
  const auto adjusted = fit.posesOf(used);
  const auto found = locateRecording(fit.recording(), fit.estimate.map, path(floor_), adjusted);
  for (size_t i = 0; i < found.size(); ++i) {
    if (!adjusted[i].empty()) continue;
    fit.estimate.T_map_base[i].reset();
    mend(fit.estimate.T_map_base[i], found[i]);
  }
}

BasePath MapDraft::pathOf(MarkerRecording whole, const std::vector<size_t>& keyframes) const {
  std::vector<InstantHypotheses> kept(whole.size());
  for (size_t i = 0; i < keyframes.size(); ++i)
    if (fit.estimate.T_map_base[i]) kept[keyframes[i]] = fit.poseAt(i);
  for (RecordedInstant& instant : whole) instant = correctedInstant(std::move(instant), fit.estimate.lenses);
  BasePath path;
  for (const InstantHypotheses& each : locateRecording(whole, fit.estimate.map, this->path(floor_), kept)) {
    path.emplace_back();
    mend(path.back(), each);
  }
  return path;
}

// Corrects markers and instants that were put on the wrong solution of their ambiguity.
bool MapDraft::mendBranches() {
  const auto found = locateRecording(fit.recording(), fit.estimate.map, path(floor_), fit.explained());
  bool any = false;
  for (size_t i = 0; i < found.size(); ++i) any |= mend(fit.estimate.T_map_base[i], found[i]);
  for (const auto& entry : fit.observations()) any |= mendMarker(entry.first, entry.second, found);
  return any;
}

bool MapDraft::mend(std::optional<Pose>& pose, const InstantHypotheses& found) const {
  if (!isUsable(found, params_->min_probability) || (pose && areClose(*pose, found[0].T_map_base)))
    return false;
  pose = found[0].T_map_base;
  return true;
}

bool MapDraft::mendMarker(const MarkerKey& key, const std::vector<RecordedObservation>& observations,
                          const std::vector<InstantHypotheses>& bases) {
  const MappedMarker *marker = fit.estimate.map.find(key), *holding = held.find(key);
  const bool doubtful =
      std::any_of(observations.begin(), observations.end(), [&](const RecordedObservation& each) {
        return marker && fit.estimate.T_map_base[each.instant] && !fit.fits(each);
      });
  if (!doubtful || (holding && holding->covariance.isZero(0.0))) return false;
  const auto places = placeMarker(fit.recording(), observations, bases, marker->size, path(floor_));
  if (places.empty() || places[0].weight < params_->min_probability ||
      areClose(marker->T_map_marker, places[0].T_map_marker))
    return false;
  MappedMarker moved = *marker;
  moved.T_map_marker = places[0].T_map_marker;
  fit.estimate.map.set(moved);
  return true;
}

}  // namespace sextant
