// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_watch.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <iterator>
#include <limits>

namespace sextant {
namespace {

constexpr double kFade = 0.96;          // an image: 25 of them are remembered
constexpr double kWatchedImages = 7.0;  // images of late
constexpr double kMostWatched = 60.0;   // that one image counts
constexpr double kFar = 26.1;           // chi-square, 8 degrees of freedom: one of 1000 lies beyond
constexpr double kMoved = 20.0;         // mean of a marker that stands elsewhere; 8 where the map is right
constexpr double kBack = 12.0;          // and of one that was put back
constexpr double kTimes = 2.5;          // of what is typical of the others
constexpr double kOffset = 0.02;        // metres; less is what maps have
constexpr double kTurned = 50.0;        // mean of one whose entry is wrong in another way

}  // namespace

Eigen::Vector3d MarkerWatch::Seen::offset() const { return information.ldlt().solve(weighted); }

void MarkerWatch::add(const LocatedPose& pose, const MarkerMap& map) {
  if (pose.used().size() < 2) return;  // one marker's word against another's
  for (const LocatedMarker& marker : pose.markers) {
    const MappedMarker* mapped = map.find(marker.key);
    if (!mapped || !marker.innovation) continue;
    const MarkerInnovation& innovation = *marker.innovation;
    const Eigen::Matrix3d information = innovation.p_covariance.ldlt().solve(Eigen::Matrix3d::Identity());
    Seen& seen = seen_[marker.key];
    seen.images = kFade * seen.images + 1;
    seen.squares = kFade * seen.squares + std::min(innovation.squared, kMostWatched);
    seen.elsewhere += innovation.squared > kFar;
    seen.information = kFade * seen.information + information;
    seen.weighted =
        kFade * seen.weighted + information * (innovation.p_map - mapped->T_map_marker.translation());
  }
  judge();
}

// Of the other markers that are trusted, the median; infinite where there is none to compare with.
double MarkerWatch::typical(const MarkerKey& but) const {
  std::vector<double> means;
  for (const auto& [key, seen] : seen_)
    if (!(key == but) && seen.images > 0 && distrusted_.count(key) == 0) means.push_back(seen.mean());
  if (means.empty()) return std::numeric_limits<double>::infinity();
  std::nth_element(means.begin(), means.begin() + means.size() / 2, means.end());
  return means[means.size() / 2];
}

// Whether a marker that is still trusted stands elsewhere.
bool MarkerWatch::isMoved(const MarkerKey& key, const Seen& seen) const {
  if (seen.images < kWatchedImages || seen.mean() < std::max(kMoved, kTimes * typical(key))) return false;
  return seen.offset().norm() > kOffset || seen.mean() > kTurned;
}

void MarkerWatch::judge() {
  std::map<double, MarkerKey> moved;  // by mean
  for (const auto& [key, seen] : seen_) {
    if (distrusted_.count(key) == 0 && isMoved(key, seen)) moved[seen.mean()] = key;
    if (seen.images >= kWatchedImages && seen.mean() < kBack) distrusted_.erase(key);
  }
  if (moved.empty()) return;
  distrusted_.insert(moved.rbegin()->second);
  for (auto& entry : seen_) entry.second.images = entry.second.squares = 0;  // it may have spoken falsely
}

std::vector<MovedMarker> MarkerWatch::moved() const {
  std::vector<MovedMarker> all;
  for (const MarkerKey& key : distrusted_) {
    const Seen& seen = seen_.at(key);
    all.push_back({key, seen.offset(), seen.elsewhere});
  }
  return all;
}

void MarkerWatch::reset() {
  seen_.clear();
  distrusted_.clear();
}

}  // namespace sextant
