// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/marker_placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "sextant/markers/marker_pose.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {
namespace {

constexpr size_t kMaxObservations = 60;  // used, spread evenly over all
constexpr size_t kMaxSuggesting = 16;    // observations whose poses are starts
constexpr size_t kMaxRefined = 4;        // starts that are refined
constexpr double kSamePlace = 0.3;       // radians or edge lengths between distinct starts
constexpr double kSameTurn = 0.15;       // radians between distinct minima
// An observation from one of the possible base poses. The unknown is T_marker_map: formally, a base at the
// map's origin is located from one marker in many cameras.
struct FromBase {
  Pose T_map_base;
  Matrix6d base_covariance;
  double cost;  // of this base pose: -2 log(probability)
};

struct Seen {
  size_t index;
  const MarkerView* view;
  const Detection* detection;
  CornerSigmas sigmas;
  std::vector<FromBase> bases;
};

// The uncertainty of the base as one of the marker, in the marker's axes: an error (dp, dr) of the base looks
// like an error -dp - dr x v, -dr of the marker.
Matrix6d seemingCovariance(const FromBase& from, const Pose& T_map_marker) {
  const Eigen::Vector3d v = T_map_marker.translation() - from.T_map_base.translation();
  const Eigen::Matrix3d R = T_map_marker.linear().transpose();
  Matrix6d A = Matrix6d::Zero();
  A << -R, R * skew(v), Eigen::Matrix3d::Zero(), -R;
  const Matrix6d covariance = A * from.base_covariance * A.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

// Covariance of T_map_marker from that of its inverse X; both position, rotation in the parent's axes.
Matrix6d inverseCovariance(const Matrix6d& X_covariance, const Pose& T_map_marker) {
  const Eigen::Matrix3d& R = T_map_marker.linear();
  Matrix6d B = Matrix6d::Zero();
  B << -R, skew(T_map_marker.translation()) * R, Eigen::Matrix3d::Zero(), -R;
  const Matrix6d covariance = B * X_covariance * B.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

MarkerObservation turnedRound(const Seen& seen, const FromBase& from, double size, const Pose& T_map_marker) {
  return {&seen.view->camera,
          seen.view->T_base_camera.inverse() * from.T_map_base.inverse(),
          Pose::Identity(),
          size,
          seen.detection->corners,
          seen.sigmas,
          seemingCovariance(from, T_map_marker)};
}

Seen seenFrom(const MarkerRecording& recording, const RecordedObservation& observation, size_t index,
              const InstantHypotheses& bases, double corner_sigma) {
  const MarkerView& view = recording[observation.instant].views[observation.view];
  const Detection& detection = view.detections[observation.detection];
  Seen seen{index, &view, &detection, cornerSigmas(view, detection, corner_sigma), {}};
  for (const PoseHypothesis& base : bases)
    seen.bases.push_back({base.T_map_base, base.covariance, -2 * std::log(base.weight)});
  return seen;
}

// At most this many elements, spread evenly.
template <typename T>
std::vector<T> spread(const std::vector<T>& all, size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  some.reserve(most);
  for (size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

std::vector<Pose> suggestions(const std::vector<Seen>& all, double size) {
  std::vector<Pose> poses;
  for (const Seen& seen : spread(all, kMaxSuggesting)) {
    const auto solved = solveMarkerPose(seen.view->camera, seen.detection->corners, size);
    if (!solved) continue;
    for (const FromBase& from : seen.bases) {
      const Pose T_map_camera = from.T_map_base * seen.view->T_base_camera;
      poses.push_back(T_map_camera * solved->best.T_camera_marker);
      if (solved->alternative) poses.push_back(T_map_camera * solved->alternative->T_camera_marker);
    }
  }
  return poses;
}

struct Choice {
  const FromBase* from;
  double cost;  // squared Mahalanobis distance, bounded by the gate, plus the cost of the base pose
};

// The base pose from which the observation fits best.
Choice choose(const Seen& seen, double size, const Pose& T_map_marker, double gate) {
  Choice best{nullptr, std::numeric_limits<double>::infinity()};
  const Pose X = T_map_marker.inverse();
  for (const FromBase& from : seen.bases) {
    const double distance = squaredMahalanobis(turnedRound(seen, from, size, T_map_marker), X);
    const double cost = std::min(distance, gate) + from.cost;
    if (cost < best.cost) best = {&from, cost};
  }
  return best;
}

bool areClose(const Pose& a, const Pose& b, double size) {
  return logSO3(a.linear().transpose() * b.linear()).norm() < kSamePlace &&
         (a.translation() - b.translation()).norm() < kSamePlace * size;
}

// The distinct suggestions with the lowest cost over all images.
std::vector<Pose> bestSuggestions(const std::vector<Seen>& all, double size, double gate) {
  std::vector<std::pair<double, Pose>> scored;
  for (const Pose& pose : suggestions(all, size)) {
    double cost = 0;
    for (const Seen& seen : all) cost += choose(seen, size, pose, gate).cost;
    scored.emplace_back(cost, pose);
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Pose> best;
  for (const auto& [cost, pose] : scored) {
    const auto alike = [&, &pose = pose](const Pose& other) { return areClose(pose, other, size); };
    if (best.size() < kMaxRefined && std::none_of(best.begin(), best.end(), alike)) best.push_back(pose);
  }
  return best;
}

struct Candidate {
  MarkerPlace place;
  double log_evidence;  // Laplace's, as of poseHypotheses()
};

std::optional<Candidate> refined(const std::vector<Seen>& all, double size, const Pose& T_map_marker,
                                 const PathParams& params) {
  std::vector<MarkerObservation> observations;
  double cost = 0;
  for (const Seen& seen : all) {
    const FromBase* from = choose(seen, size, T_map_marker, params.hypotheses.gate).from;
    observations.push_back(turnedRound(seen, *from, size, T_map_marker));
    cost += from->cost;
  }
  const HypothesesParams search{params.hypotheses.robust_width, params.hypotheses.gate, std::nullopt};
  const auto found = poseHypotheses(observations, {{T_map_marker.inverse(), 0}}, search, std::nullopt);
  if (found.empty()) return std::nullopt;
  const PoseHypothesis& best = found[0];
  const Pose T = best.T_map_base.inverse();
  const double agreement = static_cast<double>(best.used.size()) / static_cast<double>(all.size());
  Candidate candidate{{T, inverseCovariance(best.covariance, T), 0.0, {}, agreement},
                      -0.5 * (best.cost + cost) + 0.5 * std::log(best.covariance.determinant())};
  for (const size_t i : best.used) candidate.place.explained.push_back(all[i].index);
  return candidate;
}

// The two planar solutions of a marker differ in rotation; otherwise both are the same minimum with different
// images.
bool areOne(const MarkerPlace& a, const MarkerPlace& b, double size) {
  return logSO3(a.T_map_marker.linear().transpose() * b.T_map_marker.linear()).norm() < kSameTurn &&
         (a.T_map_marker.translation() - b.T_map_marker.translation()).norm() < size;
}

void addIfNew(const Candidate& found, double size, std::vector<Candidate>& all) {
  for (Candidate& other : all) {
    if (!areOne(found.place, other.place, size)) continue;
    if (found.log_evidence > other.log_evidence) other = found;
    return;
  }
  all.push_back(found);
}

std::vector<MarkerPlace> weighed(std::vector<Candidate> all) {
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.log_evidence > b.log_evidence; });
  std::vector<MarkerPlace> places;
  double sum = 0;
  for (const Candidate& each : all) sum += std::exp(each.log_evidence - all[0].log_evidence);
  for (Candidate& each : all) {
    each.place.weight = std::exp(each.log_evidence - all[0].log_evidence) / sum;
    places.push_back(each.place);
  }
  return places;
}

}  // namespace

std::vector<MarkerPlace> placeMarker(const MarkerRecording& recording,
                                     const std::vector<RecordedObservation>& observations,
                                     const std::vector<InstantHypotheses>& path, double size,
                                     const PathParams& params) {
  std::vector<size_t> located;
  for (size_t i = 0; i < observations.size(); ++i)
    if (!path[observations[i].instant].empty()) located.push_back(i);
  std::vector<Seen> all;
  for (const size_t i : spread(located, kMaxObservations))
    all.push_back(
        seenFrom(recording, observations[i], i, path[observations[i].instant], params.corner_sigma));
  std::vector<Candidate> candidates;
  for (const Pose& pose : bestSuggestions(all, size, params.hypotheses.gate))
    if (const auto found = refined(all, size, pose, params)) addIfNew(*found, size, candidates);
  return weighed(std::move(candidates));
}

std::optional<double> distanceFromPlace(const MarkerRecording& recording,
                                        const RecordedObservation& observation,
                                        const InstantHypotheses& bases, double size, const Pose& T_map_marker,
                                        const PathParams& params) {
  if (bases.empty()) return std::nullopt;
  const Seen seen = seenFrom(recording, observation, 0, bases, params.corner_sigma);
  return choose(seen, size, T_map_marker, std::numeric_limits<double>::infinity()).cost;
}

}  // namespace sextant
