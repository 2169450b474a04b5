// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/map_growth.hpp"

#include <array>
#include <map>
#include <utility>

#include "sextant/localization/mapped_observation.hpp"
#include "sextant/mapping/marker_placement.hpp"

namespace sextant {
namespace {

// Minimum number of observations that fit the pose of a new marker; the next one is tried if no marker
// reaches it.
constexpr std::array<size_t, 3> kImages = {5, 2, 1};

// Number of markers from which an instant is located well enough not to be located again with new ones.
constexpr size_t kEnoughMarkers = 6;

constexpr double kAgreement = 0.34;  // a pose must explain more than this fraction of the observations

struct Placed {
  MarkerKey key;
  MarkerPlace place;
};

class Growth {
 public:
  Growth(const MarkerRecording& recording, const MarkerSizes& sizes, const MarkerMap& start,
         const PathParams& params, const std::set<MarkerKey>& without)
      : recording_(recording),
        sizes_(sizes),
        params_(params),
        map_(start),
        observations_(observationsByMarker(recording)) {
    for (const MarkerKey& key : without) observations_.erase(key);
  }

  GrownMap grow() {
    do path_ = locateRecording(recording_, map_, params_, std::move(path_));
    while (addRing());
    BasePath best;
    for (const InstantHypotheses& each : path_) best.push_back(bestOf(each));
    return {{map_, best}, ambiguous_};
  }

 private:
  std::optional<Pose> bestOf(const InstantHypotheses& all) const {
    if (!isUsable(all, params_.min_probability)) return std::nullopt;
    return all[0].T_map_base;
  }

  // Returns whether a marker was added.
  bool addRing() {
    ambiguous_.clear();
    std::vector<Placed> unambiguous;
    for (const auto& [key, observations] : observations_) {
      if (map_.find(key)) continue;
      const auto places = placeMarker(recording_, observations, path_, sizes_.of(key), params_);
      if (places.empty()) continue;
      if (places[0].weight >= params_.min_probability && places[0].agreement > kAgreement)
        unambiguous.push_back({key, places[0]});
      else
        ambiguous_.insert(key);
    }
    for (const size_t images : kImages)
      if (addThose(unambiguous, images)) return true;
    return false;
  }

  bool addThose(const std::vector<Placed>& unambiguous, size_t images) {
    bool any = false;
    for (const auto& [key, place] : unambiguous) {
      if (place.explained.size() < images) continue;
      map_.add({key, sizes_.of(key), "", place.T_map_marker, place.covariance});
      for (const RecordedObservation& each : observations_.at(key))
        if (!isWellLocated(path_[each.instant])) path_[each.instant].clear();
      any = true;
    }
    for (InstantHypotheses& each : path_)
      if (!each.empty() && each[0].used.empty())
        each.clear();  // located by odometry only: try again with the new markers
    return any;
  }

  bool isWellLocated(const InstantHypotheses& all) const {
    return isUnambiguous(all, params_.min_probability) && all[0].used.size() >= kEnoughMarkers;
  }

  const MarkerRecording& recording_;
  const MarkerSizes& sizes_;
  const PathParams& params_;
  MarkerMap map_;
  std::map<MarkerKey, std::vector<RecordedObservation>> observations_;
  std::vector<InstantHypotheses> path_;
  std::set<MarkerKey> ambiguous_;
};

}  // namespace

GrownMap growMap(const MarkerRecording& recording, const MarkerSizes& sizes, const MarkerMap& start,
                 const PathParams& params, const std::set<MarkerKey>& without) {
  return Growth(recording, sizes, start, params, without).grow();
}

std::map<MarkerKey, std::vector<RecordedObservation>> observationsByMarker(const MarkerRecording& recording) {
  std::map<MarkerKey, std::vector<RecordedObservation>> all;
  for (size_t i = 0; i < recording.size(); ++i) {
    for (size_t v = 0; v < recording[i].views.size(); ++v) {
      const MarkerView& view = recording[i].views[v];
      for (size_t d = 0; d < view.detections.size(); ++d)
        if (const MarkerKey& key = view.detections[d].key; !isRepeated(view, key))
          all[key].push_back({i, v, d});
    }
  }
  return all;
}

}  // namespace sextant
