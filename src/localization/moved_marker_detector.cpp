// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/moved_marker_detector.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

constexpr double kForgetting = 0.96;     // factor on the sums before each image: a memory of 25 images
constexpr double kMinWeight = 7.0;       // minimum weighted number of images for a decision
constexpr double kMaxInnovation = 60.0;  // limit of the squared innovation of one image
constexpr double kContradiction = 26.1;  // squared innovation: 99.9 % of chi-square, 8 degrees of freedom
// Limits of the mean squared innovation, which is 8 if the map is right.
constexpr double kMoved = 20.0;    // minimum of a moved marker
constexpr double kBack = 12.0;     // maximum of a marker that was put back
constexpr double kRotated = 50.0;  // minimum of a marker that was rotated without an offset
constexpr double kMinRatio = 2.5;  // of a moved marker's mean squared innovation to the median of the others
constexpr double kOffsetSigmas = 3.0;  // standard deviations within which an offset is none
constexpr double kMinOffset = 0.02;    // of a moved marker, metres; smaller errors are normal for maps

}  // namespace

Eigen::Vector3d MovedMarkerDetector::Statistics::offset() const {
  return information.ldlt().solve(weighted_offset);
}

double MovedMarkerDetector::Statistics::offsetSigma() const {
  return std::sqrt(information.ldlt().solve(Eigen::Matrix3d::Identity()).trace());
}

bool MovedMarkerDetector::add(const LocatedPose& pose, const MarkerMap& map) {
  if (pose.used().size() < 2)
    return false;  // a pose from one marker: if another marker contradicts it, either may have been moved
  for (const LocatedMarker& marker : pose.markers) {
    const MappedMarker* mapped = map.find(marker.key);
    if (!mapped || !marker.innovation) continue;
    const MarkerInnovation& innovation = *marker.innovation;
    const Eigen::Matrix3d information = innovation.p_covariance.ldlt().solve(Eigen::Matrix3d::Identity());
    Statistics& sums = statistics_[marker.key];
    sums.images = kForgetting * sums.images + 1;
    sums.squared_innovations =
        kForgetting * sums.squared_innovations + std::min(innovation.squared_distance, kMaxInnovation);
    sums.outliers += innovation.squared_distance > kContradiction;
    sums.information = kForgetting * sums.information + information;
    sums.weighted_offset = kForgetting * sums.weighted_offset +
                           information * (innovation.p_map - mapped->T_map_marker.translation());
  }
  return updateKeys();
}

// Median of the mean squared innovations of the other markers, except moved ones; infinite if there is none.
double MovedMarkerDetector::medianOfOthers(const MarkerKey& key) const {
  std::vector<double> means;
  for (const auto& [other, sums] : statistics_)
    if (!(other == key) && sums.images > 0 && keys_.count(other) == 0) means.push_back(sums.meanSquare());
  if (means.empty()) return std::numeric_limits<double>::infinity();
  std::nth_element(means.begin(), means.begin() + means.size() / 2, means.end());
  return means[means.size() / 2];
}

bool MovedMarkerDetector::isSuspect(const MarkerKey& key, const Statistics& sums) const {
  if (sums.images < kMinWeight || sums.meanSquare() < std::max(kMoved, kMinRatio * medianOfOthers(key)))
    return false;
  return sums.offset().norm() > kMinOffset || sums.meanSquare() > kRotated;
}

bool MovedMarkerDetector::updateKeys() {
  bool suspects = false;
  for (const auto& [key, sums] : statistics_) {
    suspects |= keys_.count(key) == 0 && isSuspect(key, sums);
    if (sums.images >= kMinWeight && sums.meanSquare() < kBack &&
        sums.offset().norm() < std::max(kMinOffset, kOffsetSigmas * sums.offsetSigma()))
      keys_.erase(key);
  }
  if (suspects) restart();
  return suspects;
}

void MovedMarkerDetector::exclude(const MarkerKey& key) {
  keys_.insert(key);
  restart();  // all innovations so far contain the error that the moved marker caused in the pose
}

void MovedMarkerDetector::restart() {
  for (auto& entry : statistics_) entry.second.images = entry.second.squared_innovations = 0;
}

std::vector<MovedMarker> MovedMarkerDetector::moved() const {
  std::vector<MovedMarker> markers;
  for (const MarkerKey& key : keys_) {
    const auto found = statistics_.find(key);
    const Statistics sums = found == statistics_.end() ? Statistics{} : found->second;
    markers.push_back({key, sums.offset(), sums.outliers});
  }
  return markers;
}

void MovedMarkerDetector::reset() {
  statistics_.clear();
  keys_.clear();
}

}  // namespace sextant
