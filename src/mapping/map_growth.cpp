// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/map_growth.hpp"

#include <array>
#include <map>
#include <utility>

#include "sextant/localization/mapped_sighting.hpp"
#include "sextant/mapping/marker_placement.hpp"

namespace sextant {
namespace {

// Markers that so many images place go before those that fewer do.
constexpr std::array<size_t, 3> kImages = {5, 2, 1};

constexpr double kAgreement = 0.34;  // share of the images that a place must explain

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
        sightings_(sightingsByMarker(recording)) {
    for (const MarkerKey& key : without) sightings_.erase(key);
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
    if (!isUsable(all, params_.decided)) return std::nullopt;
    return all[0].T_map_base;
  }

  // Whether there was one to add.
  bool addRing() {
    ambiguous_.clear();
    std::vector<Placed> decided;
    for (const auto& [key, sightings] : sightings_) {
      if (map_.find(key)) continue;
      const auto places = placeMarker(recording_, sightings, path_, sizes_.of(key), params_);
      if (places.empty()) continue;
      if (places[0].weight >= params_.decided && places[0].agreement > kAgreement)
        decided.push_back({key, places[0]});
      else
        ambiguous_.insert(key);
    }
    for (const size_t images : kImages)
      if (addThose(decided, images)) return true;
    return false;
  }

  bool addThose(const std::vector<Placed>& decided, size_t images) {
    bool any = false;
    for (const auto& [key, place] : decided) {
      if (place.explained.size() < images) continue;
      map_.add({key, sizes_.of(key), "", place.T_map_marker, place.covariance});
      for (const RecordedSighting& each : sightings_.at(key)) path_[each.instant].clear();
      any = true;
    }
    for (InstantHypotheses& each : path_)
      if (!each.empty() && each[0].used.empty()) each.clear();  // odometry knows better now
    return any;
  }

  const MarkerRecording& recording_;
  const MarkerSizes& sizes_;
  const PathParams& params_;
  MarkerMap map_;
  std::map<MarkerKey, std::vector<RecordedSighting>> sightings_;
  std::vector<InstantHypotheses> path_;
  std::set<MarkerKey> ambiguous_;
};

}  // namespace

GrownMap growMap(const MarkerRecording& recording, const MarkerSizes& sizes, const MarkerMap& start,
                 const PathParams& params, const std::set<MarkerKey>& without) {
  return Growth(recording, sizes, start, params, without).grow();
}

std::map<MarkerKey, std::vector<RecordedSighting>> sightingsByMarker(const MarkerRecording& recording) {
  std::map<MarkerKey, std::vector<RecordedSighting>> all;
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
