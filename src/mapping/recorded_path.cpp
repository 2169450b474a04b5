// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/recorded_path.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "sextant/localization/mapped_observation.hpp"

namespace sextant {
namespace {

constexpr double kImprobable = 1e-3;    // probability below which hypotheses are dropped
constexpr double kLostDeviation = 1.0;  // metres; maximum standard deviation of a useful prediction
// The search for hypotheses takes a time that grows with the square of the number of markers, while the
// largest ones in the image determine the pose.
constexpr size_t kMaxMarkers = 12;

struct InSight {
  const MarkerView* view;
  const Detection* detection;
  const MappedMarker* marker;
  double perimeter;  // pixels
};

// The mapped markers of an instant, the largest in the image if there are many.
std::vector<InSight> markersInSight(const RecordedInstant& recorded, const MarkerMap& map,
                                    const std::set<MarkerKey>& without) {
  std::vector<InSight> all;
  for (const MarkerView& view : recorded.views)
    for (const Detection& detection : view.detections)
      if (const MappedMarker* marker = map.find(detection.key);
          marker && !isRepeated(view, detection.key) && without.count(detection.key) == 0)
        all.push_back({&view, &detection, marker, perimeter(detection.corners)});
  if (all.size() <= kMaxMarkers) return all;
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.perimeter > b.perimeter; });
  all.erase(all.begin() + kMaxMarkers, all.end());
  return all;
}

// Predicts the pose at an instant from that at its neighbour, if odometry connects both.
std::optional<PosePrior> carried(const std::optional<PosePrior>& pose, const RecordedInstant& from,
                                 const RecordedInstant& to, const OdometryParams& params) {
  if (!pose || from.drive != to.drive || !from.T_odom_base || !to.T_odom_base) return std::nullopt;
  const PosePrior moved = movedByOdometry(*pose, from.T_odom_base->inverse() * *to.T_odom_base, params);
  if (moved.covariance.topLeftCorner<3, 3>().trace() > kLostDeviation * kLostDeviation) return std::nullopt;
  return moved;
}

// Predicts every instant by odometry from the last unambiguous one before it (or after it).
std::vector<std::optional<PosePrior>> priors(const MarkerRecording& recording,
                                             const std::vector<InstantHypotheses>& found,
                                             const PathParams& params, bool backwards) {
  const size_t n = recording.size();
  std::vector<std::optional<PosePrior>> all(n);
  std::optional<PosePrior> last;
  for (size_t step = 0; step < n; ++step) {
    const size_t i = backwards ? n - 1 - step : step, before = backwards ? i + 1 : i - 1;
    if (step > 0) all[i] = last = carried(last, recording[before], recording[i], params.odometry);
    if (isUnambiguous(found[i], params.min_probability))
      last = PosePrior{found[i][0].T_map_base, found[i][0].covariance};
  }
  return all;
}

const std::optional<PosePrior>& closer(const std::optional<PosePrior>& a, const std::optional<PosePrior>& b) {
  if (!a || !b) return a ? a : b;
  return a->covariance.trace() <= b->covariance.trace() ? a : b;
}

InstantHypotheses probable(InstantHypotheses all) {
  all.erase(std::find_if(all.begin(), all.end(), [](const auto& each) { return each.weight < kImprobable; }),
            all.end());
  return all;
}

PoseHypothesis fromOdometry(const PosePrior& prior) {
  return {prior.T_map_base, prior.covariance, 0.0, 0.0, {}, 0.0, 1.0};
}

}  // namespace

bool isUnambiguous(const InstantHypotheses& hypotheses, double min_probability) {
  return !hypotheses.empty() && hypotheses[0].weight >= min_probability;
}

bool isUsable(const InstantHypotheses& hypotheses, double min_probability) {
  return (!hypotheses.empty() && hypotheses[0].used.size() > 1) || isUnambiguous(hypotheses, min_probability);
}

InstantHypotheses locateInstant(const RecordedInstant& instant, const MarkerMap& map,
                                const PathParams& params, const std::optional<PosePrior>& prior,
                                const std::set<MarkerKey>& without) {
  std::vector<MarkerObservation> observations;
  std::vector<InitialPose> initial_poses;
  for (const InSight& each : markersInSight(instant, map, without)) {
    const auto poses = solveMarkerPose(each.view->camera, each.detection->corners, each.marker->size);
    if (!poses) continue;
    addInitialPoses(*each.view, *each.marker, *poses, observations.size(), initial_poses);
    observations.push_back(mappedObservation(*each.view, *each.detection, *each.marker, params.corner_sigma));
  }
  return probable(poseHypotheses(observations, initial_poses, params.hypotheses, prior));
}

std::vector<InstantHypotheses> locateRecording(const MarkerRecording& recording, const MarkerMap& map,
                                               const PathParams& params,
                                               std::vector<InstantHypotheses> kept) {
  std::vector<InstantHypotheses> found = std::move(kept);
  found.resize(recording.size());
  for (size_t i = 0; i < recording.size(); ++i)
    if (found[i].empty()) found[i] = locateInstant(recording[i], map, params, {});
  const auto before = priors(recording, found, params, false), after = priors(recording, found, params, true);
  for (size_t i = 0; i < recording.size(); ++i) {
    const auto& prior = closer(before[i], after[i]);
    if (!prior || isUnambiguous(found[i], params.min_probability)) continue;
    found[i] = found[i].empty() ? InstantHypotheses{fromOdometry(*prior)}
                                : locateInstant(recording[i], map, params, prior);
  }
  return found;
}

}  // namespace sextant
