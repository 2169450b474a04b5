// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/conflicting_poses.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "sextant/localization/mapped_observation.hpp"
#include "sextant/mapping/map_growth.hpp"
#include "sextant/mapping/marker_placement.hpp"

namespace sextant {
namespace {

constexpr size_t kMinImages = 5;       // minimum number of images that contradict the pose in the map
constexpr double kMinAgreement = 0.5;  // minimum fraction of these images that the other pose fits
constexpr double kMinDistance = 0.5;   // minimum distance of the two poses, edge lengths of the marker

// The other markers that fit the map in the images that support a pose.
std::vector<MarkerKey> witnesses(const MarkerRecording& recording,
                                 const std::vector<RecordedObservation>& observations,
                                 const std::vector<InstantHypotheses>& path, const MarkerMap& map,
                                 const MarkerKey& excluded, const MarkerPlace& place,
                                 const PathParams& params) {
  std::set<MarkerKey> found;
  for (const size_t i : place.explained) {
    const size_t instant = observations[i].instant;
    for (const MarkerView& view : recording[instant].views)
      for (const Detection& detection : view.detections) {
        const MappedMarker* marker = map.find(detection.key);
        if (!marker || detection.key == excluded || isRepeated(view, detection.key)) continue;
        const auto observation = mappedObservation(view, detection, *marker, params.corner_sigma);
        if (squaredMahalanobis(observation, path[instant][0].T_map_base) <= params.hypotheses.gate)
          found.insert(detection.key);
      }
  }
  return {found.begin(), found.end()};
}

bool isElsewhere(const MarkerPlace& place, const MappedMarker& marker) {
  const Eigen::Vector3d offset = place.T_map_marker.translation() - marker.T_map_marker.translation();
  return place.explained.size() >= kMinImages && place.agreement >= kMinAgreement &&
         offset.norm() >= kMinDistance * marker.size;
}

std::optional<ConflictingPose> conflictingPose(const MarkerRecording& recording,
                                               const std::vector<RecordedObservation>& observations,
                                               const MarkerMap& map, const MappedMarker& marker,
                                               const std::vector<InstantHypotheses>& explained,
                                               const PathParams& params) {
  std::vector<InstantHypotheses> path(recording.size());
  std::vector<RecordedObservation> contradicting;
  for (const RecordedObservation& each : observations) {
    path[each.instant] = explained[each.instant];
    if (path[each.instant].empty())
      path[each.instant] = locateInstant(recording[each.instant], map, params, {}, {marker.key});
    const auto distance =
        distanceFromPlace(recording, each, path[each.instant], marker.size, marker.T_map_marker, params);
    if (distance && *distance > params.hypotheses.gate) contradicting.push_back(each);
  }
  if (contradicting.size() < kMinImages) return std::nullopt;
  const auto places = placeMarker(recording, contradicting, path, marker.size, params);
  if (places.empty() || !isElsewhere(places[0], marker)) return std::nullopt;
  return ConflictingPose{marker.key, places[0].T_map_marker, contradicting.size(),
                         witnesses(recording, contradicting, path, map, marker.key, places[0], params)};
}

}  // namespace

std::vector<ConflictingPose> conflictingPoses(const MarkerRecording& recording, const MarkerMap& map,
                                              const std::vector<InstantHypotheses>& explained,
                                              const PathParams& params) {
  std::vector<ConflictingPose> all;
  for (const auto& [key, observations] : observationsByMarker(recording)) {
    const MappedMarker* marker = map.find(key);
    if (!marker) continue;
    if (const auto found = conflictingPose(recording, observations, map, *marker, explained, params))
      all.push_back(*found);
  }
  std::stable_sort(all.begin(), all.end(), [](const ConflictingPose& a, const ConflictingPose& b) {
    return std::make_pair(a.witnesses.size(), a.images) > std::make_pair(b.witnesses.size(), b.images);
  });
  return all;
}

}  // namespace sextant
