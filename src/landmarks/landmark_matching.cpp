// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_matching.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "sextant/landmarks/landmark_sensor.hpp"

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kDistanceDeviations = 3.0;  // that a distance may be off by
constexpr double kMargin = 1.0;              // metres about the map, in which landmarks may be as well
constexpr double kLeastDeviation = 1e-3;     // metres, of a distance's deviation
constexpr double kNever = -1e9;
constexpr size_t kNeighbours = 5;
constexpr double kMisread = 1e-3;      // how often an id is another one's
constexpr double kSamePlace = 1.0;     // metres that two hypotheses of one pose may be apart in the mean
constexpr double kSameHeading = 0.35;  // radians

struct Hypothesis {
  LandmarkMatch match;
  double evidence = 0;  // log likelihood ratio to landmarks at random
};

/// The pose by which a pair of points comes to lie on another one, middle on middle.
Pose2 poseOfPairs(const Vector2d& a, const Vector2d& b, const Vector2d& A, const Vector2d& B) {
  const Vector2d way = b - a, Way = B - A;
  const double heading = wrapped(std::atan2(Way.y(), Way.x()) - std::atan2(way.y(), way.x()));
  return {0.5 * (A + B) - rotation2(heading) * (0.5 * (a + b)), heading};
}

/// Least squares over all pairs (Umeyama 1991 in the plane).
Pose2 poseOfAll(const std::vector<MapPoint>& local, const std::vector<MapPoint>& map,
                const LandmarkMatch& match) {
  if (match.pairs.size() < 2) return match.T_map_local;
  Vector2d a = Vector2d::Zero(), b = Vector2d::Zero();
  for (const auto& [i, j] : match.pairs) a += local[i].landmark.position, b += map[j].landmark.position;
  a /= static_cast<double>(match.pairs.size()), b /= static_cast<double>(match.pairs.size());
  double along = 0, across = 0;
  for (const auto& [i, j] : match.pairs) {
    const Vector2d u = local[i].landmark.position - a, v = map[j].landmark.position - b;
    along += u.dot(v);
    across += u.x() * v.y() - u.y() * v.x();
  }
  const double heading = std::atan2(across, along);
  return {b - rotation2(heading) * a, heading};
}

class Matcher {
 public:
  Matcher(const std::vector<MapPoint>& local, const std::vector<MapPoint>& map,
          const LandmarkMatchingParams& params)
      : local_(local), map_(map), params_(params), gate_(-2 * std::log1p(-params.gate)) {
    Vector2d low = map.front().landmark.position, high = low;
    for (const MapPoint& each : map) {
      low = low.cwiseMin(each.landmark.position);
      high = high.cwiseMax(each.landmark.position);
    }
    area_ = (high - low + Vector2d::Constant(2 * kMargin)).prod();
    for (const MapPoint& each : map) map_off_.push_back(largestDeviation(each.covariance));
    for (const MapPoint& each : local) off_.push_back(largestDeviation(each.covariance));
    most_off_ = *std::max_element(map_off_.begin(), map_off_.end());
    for (const MapPoint& each : local) {
      alike_.emplace_back();
      for (size_t j = 0; j < map.size(); ++j)
        if (map[j].label == each.label) alike_.back().push_back(j);
      std::sort(alike_.back().begin(), alike_.back().end(), [&](size_t a, size_t b) { return x(a) < x(b); });
    }
  }

  std::optional<LandmarkMatch> run() {
    for (size_t i = 0; i < local_.size(); ++i) {
      tryHeading(i);
      for (const size_t j : nearestTo(i)) tryPair(i, j);
    }
    if (hypotheses_.empty()) return {};
    const auto is_worse = [](const Hypothesis& a, const Hypothesis& b) { return a.evidence < b.evidence; };
    const Hypothesis best = *std::max_element(hypotheses_.begin(), hypotheses_.end(), is_worse);
    const double needed = std::log(params_.certainty / (1 - params_.certainty));
    if (best.evidence - std::log(static_cast<double>(tried_)) < needed) return {};
    for (const Hypothesis& other : hypotheses_)
      if (isOther(best.match.T_map_local, other.match.T_map_local) && best.evidence - other.evidence < needed)
        return {};
    return best.match;
  }

 private:
  void tryHeading(size_t i) {
    const MapPoint& point = local_[i];
    if (!point.label.id || !point.landmark.heading) return;
    for (const size_t k : alike_[i]) {
      const PlaneLandmark& other = map_[k].landmark;
      if (!other.heading) continue;
      const double heading = wrapped(*other.heading - *point.landmark.heading);
      weigh({other.position - rotation2(heading) * point.landmark.position, heading});
    }
  }

  /// Others of the small map: how they lie to one another is known best, and the work grows with its size
  /// only.
  std::vector<size_t> nearestTo(size_t i) const {
    std::vector<size_t> others;
    for (size_t j = 0; j < local_.size(); ++j)
      if (j != i) others.push_back(j);
    const auto is_nearer = [&](size_t a, size_t b) {
      const Vector2d& from = local_[i].landmark.position;
      return (local_[a].landmark.position - from).norm() < (local_[b].landmark.position - from).norm();
    };
    std::sort(others.begin(), others.end(), is_nearer);
    others.resize(std::min(others.size(), kNeighbours));
    return others;
  }

  void tryPair(size_t i, size_t j) {
    const Vector2d &a = local_[i].landmark.position, &b = local_[j].landmark.position;
    const double apart = (a - b).norm(), off = off_[i] + off_[j] + kLeastDeviation;
    for (const size_t k : alike_[i]) {
      const Vector2d& A = map_[k].landmark.position;
      for (const size_t l : alike_[j]) {
        const Vector2d& B = map_[l].landmark.position;
        const double most = kDistanceDeviations * (off + map_off_[k] + map_off_[l]);
        if (l != k && std::abs((A - B).norm() - apart) < most) weigh(poseOfPairs(a, b, A, B));
      }
    }
  }

  /// Twice: the pose of two landmarks is refined by all that agree with it.
  void weigh(const Pose2& T_map_local) {
    ++tried_;
    Hypothesis hypothesis{{T_map_local, {}}, 0};
    for (int round = 0; round < 2; ++round) {
      hypothesis = weighed(hypothesis.match.T_map_local);
      hypothesis.match.T_map_local = poseOfAll(local_, map_, hypothesis.match);
    }
    if (hypothesis.evidence > 0) hypotheses_.push_back(hypothesis);
  }

  Hypothesis weighed(const Pose2& T_map_local) const {
    Hypothesis found{{T_map_local, {}}, 0};
    const Matrix2d R = rotation2(T_map_local.heading);
    for (size_t i = 0; i < local_.size(); ++i) {
      const Vector2d expected = T_map_local.position + R * local_[i].landmark.position;
      double best = std::log(1 - params_.present);
      std::optional<size_t> of;
      const double reach = std::sqrt(gate_) * (off_[i] + most_off_ + kLeastDeviation);
      for (auto at = firstFrom(i, expected.x() - reach);
           at != alike_[i].end() && x(*at) <= expected.x() + reach; ++at) {
        const size_t j = *at;
        const Vector2d off = map_[j].landmark.position - expected;
        if (off.norm() > reach || isTaken(found.match, j)) continue;
        const double evidence = evidenceOf(off, R * local_[i].covariance * R.transpose(), i, j);
        if (evidence > best) best = evidence, of = j;
      }
      found.evidence += best;
      if (of) found.match.pairs.emplace_back(i, *of);
    }
    return found;
  }

  double x(size_t of_map) const { return map_[of_map].landmark.position.x(); }

  std::vector<size_t>::const_iterator firstFrom(size_t i, double least) const {
    return std::lower_bound(alike_[i].begin(), alike_[i].end(), least,
                            [this](size_t j, double value) { return x(j) < value; });
  }

  static bool isTaken(const LandmarkMatch& match, size_t j) {
    return std::any_of(match.pairs.begin(), match.pairs.end(),
                       [j](const auto& pair) { return pair.second == j; });
  }

  /// log of the density of a landmark that is this one of the map, over that of any.
  double evidenceOf(const Vector2d& off, const Matrix2d& covariance, size_t i, size_t j) const {
    const Matrix2d S =
        covariance + map_[j].covariance + kLeastDeviation * kLeastDeviation * Matrix2d::Identity();
    const double distance = off.dot(S.inverse() * off);
    if (distance > gate_) return kNever;
    const double density = static_cast<double>(alike_[i].size()) / area_;
    const double by_id = local_[i].label.id ? -std::log(kMisread) : 0.0;
    return std::log(params_.present) - 0.5 * distance - 0.5 * std::log(S.determinant()) -
           std::log(2 * M_PI * density) + by_id;
  }

  /// Whether two poses put the small map to different places.
  bool isOther(const Pose2& a, const Pose2& b) const {
    double apart = 0;
    for (const MapPoint& each : local_)
      apart += (a * each.landmark.position - b * each.landmark.position).norm();
    return apart / static_cast<double>(local_.size()) > kSamePlace ||
           std::abs(wrapped(a.heading - b.heading)) > kSameHeading;
  }

  const std::vector<MapPoint>&local_, &map_;
  const LandmarkMatchingParams& params_;
  double gate_, area_ = 0, most_off_ = 0;
  std::vector<double> off_, map_off_;       // largest deviation of each landmark
  std::vector<std::vector<size_t>> alike_;  // landmarks of the map with the label of each local one
  std::vector<Hypothesis> hypotheses_;
  size_t tried_ = 0;
};

}  // namespace

ParamList LandmarkMatchingParams::fields() {
  return {
      {"gate", &gate, Range::openHigh(0.5, 1), "", "lost: probability within which two landmarks are one"},
      {"certainty", &certainty, Range::openHigh(0.5, 1), "",
       "lost: probability that a match is right from which it is accepted"},
      {"present", &present, Range::closed(0.01, 0.99), "",
       "lost: probability that what is seen is in the map"},
  };
}

std::optional<LandmarkMatch> matchLandmarks(const std::vector<MapPoint>& local,
                                            const std::vector<MapPoint>& map,
                                            const LandmarkMatchingParams& params) {
  if (local.empty() || map.empty()) return {};
  return Matcher(local, map, params).run();
}

}  // namespace sextant
