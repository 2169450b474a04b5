// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_register.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "sextant/landmarks/landmark_sensor.hpp"

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

constexpr double kMaxLogOdds = 8.0;   // upper bound
constexpr double kMinLogOdds = -4.0;  // at which a landmark is removed
constexpr double kNextTo = 1.0;       // metres between two landmarks that are seen from the same direction

}  // namespace

std::optional<size_t> LandmarkRegister::find(const LandmarkLabel& label) const {
  const auto at = std::find(labels_.begin(), labels_.end(), label);
  if (at == labels_.end()) return {};
  return static_cast<size_t>(at - labels_.begin());
}

std::vector<MapPoint> LandmarkRegister::points() const {
  std::vector<MapPoint> all;
  for (size_t i = 0; i < labels_.size(); ++i)
    all.push_back({filter_.landmarks()[i], labels_[i], filter_.covariance({i}).block<2, 2>(3, 3)});
  return all;
}

std::vector<MapPoint> LandmarkRegister::pointsInRobotFrame() {
  std::vector<MapPoint> all;
  for (size_t i = 0; i < labels_.size(); ++i)
    all.push_back({toRobotFrame(filter_.pose(), filter_.landmarks()[i]), labels_[i],
                   filter_.predictObservations({i}).covariance});
  return all;
}

void LandmarkRegister::add(const LabelledObservation& observation) {
  filter_.add(observation.observation);
  labels_.push_back(observation.label);
  keys_.push_back(next_key_++);
  existence_.push_back({});
}

void LandmarkRegister::addEvidence(const std::vector<size_t>& landmarks, double evidence) {
  for (const size_t each : landmarks) {
    double& log_odds = existence_[each].log_odds;
    log_odds = std::min(log_odds + evidence, kMaxLogOdds);
  }
}

bool LandmarkRegister::countsAsMissed(size_t landmark, const std::vector<size_t>& observed) const {
  return isNewMiss(landmark, observed, existence_[landmark].missed_from);
}

bool LandmarkRegister::isUnlikelyMiss(size_t landmark, const std::vector<size_t>& observed) const {
  return isNewMiss(landmark, observed, existence_[landmark].noted_from);
}

/// @param last position of the robot
bool LandmarkRegister::isNewMiss(size_t landmark, const std::vector<size_t>& observed,
                                 const std::optional<Vector2d>& last) const {
  const auto& landmarks = filter_.landmarks();
  const auto distance = [&](const Vector2d& point) { return (landmarks[landmark].position - point).norm(); };
  const auto is_near = [&](size_t other) { return distance(landmarks[other].position) < kNextTo; };
  if (std::any_of(observed.begin(), observed.end(), is_near)) return true;
  return !last || isNewView(*last, filter_.pose().position, landmarks[landmark].position);
}

void LandmarkRegister::noteMisses(const std::vector<size_t>& missed, const std::vector<size_t>& observed) {
  for (const size_t each : missed)
    if (isUnlikelyMiss(each, observed)) existence_[each].noted_from = filter_.pose().position;
}

void LandmarkRegister::addMisses(const std::vector<size_t>& missed, const std::vector<size_t>& observed,
                                 double evidence) {
  for (const size_t each : missed) {
    if (!countsAsMissed(each, observed)) continue;
    existence_[each].missed_from = filter_.pose().position;
    addEvidence({each}, evidence);
  }
}

bool LandmarkRegister::isEstablished(size_t landmark) const {
  return existence_[landmark].log_odds > kMaxLogOdds / 2;
}

int LandmarkRegister::mergeDuplicates(std::vector<size_t> observed, double separation,
                                      std::vector<std::optional<int>>& keys) {
  const size_t before = labels_.size();
  for (size_t k = 0; k < observed.size(); ++k) {
    while (const auto other = duplicateOf(observed[k], observed, separation)) {
      const size_t kept = std::min(observed[k], *other), gone = std::max(observed[k], *other);
      existence_[kept].log_odds = std::max(existence_[kept].log_odds, existence_[gone].log_odds);
      std::replace(keys.begin(), keys.end(), std::optional(keys_[gone]), std::optional(keys_[kept]));
      filter_.merge(kept, gone);
      eraseEntry(gone);
      for (size_t& each : observed) each = each == gone ? kept : each - (each > gone);
    }
  }
  return static_cast<int>(before - labels_.size());
}

std::optional<size_t> LandmarkRegister::duplicateOf(size_t landmark, const std::vector<size_t>& observed,
                                                    double separation) const {
  for (size_t other = 0; other < labels_.size(); ++other) {
    const bool is_observed = std::find(observed.begin(), observed.end(), other) != observed.end();
    if (!is_observed && areDuplicates(landmark, other, separation)) return other;
  }
  return std::nullopt;
}

bool LandmarkRegister::areDuplicates(size_t a, size_t b, double separation) const {
  if (!(labels_[a] == labels_[b])) return false;
  const auto& landmarks = filter_.landmarks();
  const Vector2d apart = landmarks[a].position - landmarks[b].position;
  if (apart.norm() > separation) return false;
  const MatrixXd covariance = filter_.covariance({a, b});
  const Eigen::Index at = 3, next = 3 + landmarks[a].dimension();
  const Matrix2d cross = covariance.block<2, 2>(at, next);
  const Matrix2d S =
      covariance.block<2, 2>(at, at) + covariance.block<2, 2>(next, next) - cross - cross.transpose();
  return apart.norm() + 2 * largestDeviation(S) < separation;
}

int LandmarkRegister::removeUnlikely() {
  const size_t before = labels_.size();
  for (size_t i = before; i-- > 0;)
    if (existence_[i].log_odds <= kMinLogOdds) remove(i);
  return static_cast<int>(before - labels_.size());
}

void LandmarkRegister::removeFrom(int key) {
  for (size_t i = labels_.size(); i-- > 0;)
    if (keys_[i] >= key) remove(i);
}

void LandmarkRegister::remove(size_t landmark) {
  filter_.remove(landmark);
  eraseEntry(landmark);
}

void LandmarkRegister::eraseEntry(size_t landmark) {
  const auto at = static_cast<std::ptrdiff_t>(landmark);
  labels_.erase(labels_.begin() + at);
  keys_.erase(keys_.begin() + at);
  existence_.erase(existence_.begin() + at);
}

void LandmarkRegister::setMap(const Pose2& T_map_base, const std::vector<Landmark2D>& landmarks,
                              const std::vector<LandmarkLabel>& labels, const MatrixXd& covariance) {
  if (labels.size() != landmarks.size()) throw std::invalid_argument("every landmark needs a label");
  filter_.setState(T_map_base, landmarks, covariance);
  labels_ = labels;
  keys_.resize(labels.size());
  std::iota(keys_.begin(), keys_.end(), next_key_);
  next_key_ += static_cast<int>(labels.size());
  existence_.assign(labels.size(), {kMaxLogOdds, {}, {}});
}

}  // namespace sextant
