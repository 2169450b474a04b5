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

constexpr double kSure = 8.0;      // log odds that a landmark never has more of
constexpr double kDoubted = -4.0;  // and with which it goes

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

void LandmarkRegister::add(const LabelledSighting& sighting) {
  filter_.add(sighting.sighting);
  labels_.push_back(sighting.label);
  keys_.push_back(next_key_++);
  standing_.push_back(0);
}

void LandmarkRegister::judge(const std::vector<size_t>& landmarks, double evidence) {
  for (const size_t each : landmarks) standing_[each] = std::min(standing_[each] + evidence, kSure);
}

int LandmarkRegister::mergeSame(std::vector<size_t> seen, double separation,
                                std::vector<std::optional<int>>& told) {
  int gone_ones = 0;
  for (size_t k = 0; k < seen.size(); ++k) {
    for (size_t other = 0; other < labels_.size(); ++other) {
      const bool is_seen = std::find(seen.begin(), seen.end(), other) != seen.end();
      if (is_seen || !areOne(seen[k], other, separation)) continue;
      const size_t kept = std::min(seen[k], other), gone = std::max(seen[k], other);
      standing_[kept] = std::max(standing_[kept], standing_[gone]);
      std::replace(told.begin(), told.end(), std::optional(keys_[gone]), std::optional(keys_[kept]));
      filter_.merge(kept, gone);
      forget(gone);
      ++gone_ones;
      for (size_t& each : seen) each = each == gone ? kept : each - (each > gone);
      other = 0;
    }
  }
  return gone_ones;
}

bool LandmarkRegister::areOne(size_t a, size_t b, double separation) const {
  if (!(labels_[a] == labels_[b])) return false;
  const auto& landmarks = filter_.landmarks();
  const Vector2d apart = landmarks[a].position - landmarks[b].position;
  if (apart.norm() > separation) return false;
  const MatrixXd covariance = filter_.covariance({a, b});
  const Eigen::Index at = 3, next = 3 + landmarks[a].width();
  const Matrix2d cross = covariance.block<2, 2>(at, next);
  const Matrix2d S =
      covariance.block<2, 2>(at, at) + covariance.block<2, 2>(next, next) - cross - cross.transpose();
  return apart.norm() + 2 * largestDeviation(S) < separation;
}

int LandmarkRegister::removeDoubted() {
  const size_t before = labels_.size();
  for (size_t i = before; i-- > 0;)
    if (standing_[i] <= kDoubted) remove(i);
  return static_cast<int>(before - labels_.size());
}

void LandmarkRegister::removeFrom(int key) {
  for (size_t i = labels_.size(); i-- > 0;)
    if (keys_[i] >= key) remove(i);
}

void LandmarkRegister::remove(size_t landmark) {
  filter_.remove(landmark);
  forget(landmark);
}

void LandmarkRegister::forget(size_t landmark) {
  const auto at = static_cast<std::ptrdiff_t>(landmark);
  labels_.erase(labels_.begin() + at);
  keys_.erase(keys_.begin() + at);
  standing_.erase(standing_.begin() + at);
}

void LandmarkRegister::setMap(const Pose2& T_map_base, const std::vector<PlaneLandmark>& landmarks,
                              const std::vector<LandmarkLabel>& labels, const MatrixXd& covariance) {
  if (labels.size() != landmarks.size()) throw std::invalid_argument("every landmark needs a label");
  filter_.setState(T_map_base, landmarks, covariance);
  labels_ = labels;
  keys_.resize(labels.size());
  std::iota(keys_.begin(), keys_.end(), next_key_);
  next_key_ += static_cast<int>(labels.size());
  standing_.assign(labels.size(), kSure);
}

}  // namespace sextant
