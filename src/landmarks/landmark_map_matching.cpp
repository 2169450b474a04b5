// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_map_matching.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "sextant/landmarks/landmark_sensor.hpp"

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kDistanceDeviations = 3.0;  // within which two distances are equal
constexpr double kMargin = 1.0;              // metres around the map in which random landmarks may lie
constexpr double kMinDeviation = 1e-3;       // metres, minimum standard deviation of a distance
constexpr double kImpossible = -1e9;         // log likelihood ratio
constexpr size_t kNeighbours = 5;
constexpr double kMisread = 1e-3;      // probability of a wrong id
constexpr double kSamePlace = 1.0;     // metres: mean distance within which two hypotheses are the same
constexpr double kSameHeading = 0.35;  // radians

struct Hypothesis {
  LandmarkMapMatch match;
  double evidence = 0;  // log likelihood ratio to random landmarks
};

/// Pose that aligns a pair of points (a, b) with another one (A, B), centre on centre.
Pose2 poseOfPairs(const Vector2d& a, const Vector2d& b, const Vector2d& A, const Vector2d& B) {
  const Vector2d ab = b - a, AB = B - A;
  const double heading = wrapped(std::atan2(AB.y(), AB.x()) - std::atan2(ab.y(), ab.x()));
  return {0.5 * (A + B) - rotation2(heading) * (0.5 * (a + b)), heading};
}

/// Least-squares pose over all pairs (Umeyama 1991, in the plane).
Pose2 poseOfAll(const std::vector<MapPoint>& local, const std::vector<MapPoint>& map,
                const LandmarkMapMatch& match) {
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
          const LandmarkMapMatchingParams& params)
      : local_(local), map_(map), params_(params), gate_(-2 * std::log1p(-params.gate)) {
    Vector2d low = map.front().landmark.position, high = low;
    for (const MapPoint& each : map) {
      low = low.cwiseMin(each.landmark.position);
      high = high.cwiseMax(each.landmark.position);
    }
    area_ = (high - low + Vector2d::Constant(2 * kMargin)).prod();
    for (const MapPoint& each : map) map_off_.push_back(largestDeviation(each.covariance));
    for (const MapPoint& each : local) off_.push_back(largestDeviation(each.covariance));
    max_map_off_ = *std::max_element(map_off_.begin(), map_off_.end());
    for (const MapPoint& each : local) {
      same_label_.emplace_back();
      for (size_t j = 0; j < map.size(); ++j)
        if (map[j].label == each.label) same_label_.back().push_back(j);
      std::sort(same_label_.back().begin(), same_label_.back().end(),
                [&](size_t a, size_t b) { return x(a) < x(b); });
    }
  }

  std::optional<LandmarkMapMatch> run() {
    for (size_t i = 0; i < local_.size(); ++i) {
      tryHeading(i);
      for (const size_t j : nearestTo(i)) tryPair(i, j);
    }
    if (hypotheses_.empty()) return {};
    const auto is_worse = [](const Hypothesis& a, const Hypothesis& b) { return a.evidence < b.evidence; };
    const Hypothesis best = *std::max_element(hypotheses_.begin(), hypotheses_.end(), is_worse);
    const double needed = std::log(params_.min_probability / (1 - params_.min_probability));
    if (best.evidence - std::log(static_cast<double>(hypothesis_count_)) < needed) return {};
    for (const Hypothesis& other : hypotheses_)
      if (isOther(best.match.T_map_local, other.match.T_map_local) && best.evidence - other.evidence < needed)
        return {};
    return best.match;
  }

 private:
  void tryHeading(size_t i) {
    const MapPoint& point = local_[i];
    if (!point.label.id || !point.landmark.heading) return;
    for (const size_t k : same_label_[i]) {
      const Landmark2D& other = map_[k].landmark;
      if (!other.heading) continue;
      const double heading = wrapped(*other.heading - *point.landmark.heading);
      score({other.position - rotation2(heading) * point.landmark.position, heading});
    }
  }

  /// Nearest local landmarks: their relative positions are known best, and the number of hypotheses stays
  /// linear.
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
    const double apart = (a - b).norm(), off = off_[i] + off_[j] + kMinDeviation;
    for (const size_t k : same_label_[i]) {
      const Vector2d& A = map_[k].landmark.position;
      for (const size_t l : same_label_[j]) {
        const Vector2d& B = map_[l].landmark.position;
        const double most = kDistanceDeviations * (off + map_off_[k] + map_off_[l]);
        if (l != k && std::abs((A - B).norm() - apart) < most) score(poseOfPairs(a, b, A, B));
      }
    }
  }

  /// Scores a pose, refined twice with all pairs that agree with it.
  void score(const Pose2& T_map_local) {
    ++hypothesis_count_;
    Hypothesis hypothesis{{T_map_local, {}}, 0};
    for (int round = 0; round < 2; ++round) {
      hypothesis = scored(hypothesis.match.T_map_local);
      hypothesis.match.T_map_local = poseOfAll(local_, map_, hypothesis.match);
    }
    if (hypothesis.evidence > 0) hypotheses_.push_back(hypothesis);
  }

  Hypothesis scored(const Pose2& T_map_local) const {
    Hypothesis found{{T_map_local, {}}, 0};
    const Matrix2d R = rotation2(T_map_local.heading);
    for (size_t i = 0; i < local_.size(); ++i) {
      const Vector2d expected = T_map_local.position + R * local_[i].landmark.position;
      double best = std::log(1 - params_.inlier_probability);
      std::optional<size_t> of;
      const double reach = std::sqrt(gate_) * (off_[i] + max_map_off_ + kMinDeviation);
      for (auto at = firstFrom(i, expected.x() - reach);
           at != same_label_[i].end() && x(*at) <= expected.x() + reach; ++at) {
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
    return std::lower_bound(same_label_[i].begin(), same_label_[i].end(), least,
                            [this](size_t j, double value) { return x(j) < value; });
  }

  static bool isTaken(const LandmarkMapMatch& match, size_t j) {
    return std::any_of(match.pairs.begin(), match.pairs.end(),
                       [j](const auto& pair) { return pair.second == j; });
  }

  /// Log ratio of the probability density of this landmark of the map to that of a random one.
  double evidenceOf(const Vector2d& off, const Matrix2d& covariance, size_t i, size_t j) const {
    const Matrix2d S = covariance + map_[j].covariance + kMinDeviation * kMinDeviation * Matrix2d::Identity();
    const double distance = off.dot(S.inverse() * off);
    if (distance > gate_) return kImpossible;
    const double density = static_cast<double>(same_label_[i].size()) / area_;
    const double by_id = local_[i].label.id ? -std::log(kMisread) : 0.0;
    return std::log(params_.inlier_probability) - 0.5 * distance - 0.5 * std::log(S.determinant()) -
           std::log(2 * M_PI * density) + by_id;
  }

  /// Whether two poses place the local map differently.
  bool isOther(const Pose2& a, const Pose2& b) const {
    double apart = 0;
    for (const MapPoint& each : local_)
      apart += (a * each.landmark.position - b * each.landmark.position).norm();
    return apart / static_cast<double>(local_.size()) > kSamePlace ||
           std::abs(wrapped(a.heading - b.heading)) > kSameHeading;
  }

  const std::vector<MapPoint>&local_, &map_;
  const LandmarkMapMatchingParams& params_;
  double gate_, area_ = 0, max_map_off_ = 0;
  std::vector<double> off_, map_off_;  // largest standard deviation of each landmark
  std::vector<std::vector<size_t>>
      same_label_;  // landmarks of the map with the same label, by local landmark
  std::vector<Hypothesis> hypotheses_;
  size_t hypothesis_count_ = 0;
};

}  // namespace

ParamList LandmarkMapMatchingParams::fields() {
  return {
      {"gate", &gate, Range::openHigh(0.5, 1), "",
       "relocalization: probability of the gate within which two landmarks match"},
      {"min_probability", &min_probability, Range::openHigh(0.5, 1), "",
       "relocalization: minimum probability at which a match is accepted"},
      {"inlier_probability", &inlier_probability, Range::closed(0.01, 0.99), "",
       "relocalization: prior probability that an observed landmark is in the map"},
  };
}

std::optional<LandmarkMapMatch> matchLandmarkMaps(const std::vector<MapPoint>& local,
                                                  const std::vector<MapPoint>& map,
                                                  const LandmarkMapMatchingParams& params) {
  if (local.empty() || map.empty()) return {};
  return Matcher(local, map, params).run();
}

}  // namespace sextant
