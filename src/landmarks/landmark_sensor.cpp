// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_sensor.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sextant {

using Eigen::Index;
using Eigen::Vector2d;

namespace {

constexpr double kViewDeviations = 3.0;  // that robot and landmarks may be off

Vector2d positionOf(const SightingPrediction& expected, Index which) {
  return expected.positions.segment<2>(2 * which);
}

double offOf(const SightingPrediction& expected, Index which) {
  return kViewDeviations * largestDeviation(expected.covariance.block<2, 2>(2 * which, 2 * which));
}

}  // namespace

double largestDeviation(const Eigen::Matrix2d& covariance) {
  return std::sqrt(std::max(0.0, covariance.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff()));
}

ParamList LandmarkSensorParams::fields() {
  return {
      {"max_range", &max_range, Range::openLow(0, 1000), "m", "how far the sensor surely sees"},
      {"min_range", &min_range, Allowed(Range::closed(0, max_range), "[0, `max_range`]"), "m",
       "from where on it surely sees: what is nearer may be missed"},
      {"field_of_view", &field_of_view, Allowed(Range::openLow(0, 2 * M_PI), "(0, 2π]"), "rad",
       "of all directions that it surely sees, about the x axis of the sightings' frame, or the optical axis "
       "of a camera of markers"},
      {"detection", &detection, Range::closed(0.01, 0.99), "", "probability that it sees what is there"},
      {"phantom", &phantom, Range::closed(0.001, 0.5), "", "probability that a sighting is of nothing"},
      {"width", &width, Range::closed(0, 100), "m", "of landmarks: what stands behind one is not seen"},
      {"separation", &separation, Range::closed(0, 100), "m",
       "two landmarks of a class are never nearer: nearer ones are one"},
  };
}

LandmarkSensor::LandmarkSensor(const LandmarkSensorParams& params) : params_(params) { validate(params); }

std::vector<size_t> LandmarkSensor::surelyInView(const SightingPrediction& in_base,
                                                 const Pose2& T_base_sensor) const {
  SightingPrediction expected = in_base;  // deviations are the largest in any direction: they need no turning
  const Pose2 T_sensor_base = T_base_sensor.inverse();
  for (Index which = 0; which < expected.positions.size() / 2; ++which)
    expected.positions.segment<2>(2 * which) = T_sensor_base * positionOf(in_base, which);
  std::vector<size_t> found;
  for (Index which = 0; which < expected.positions.size() / 2; ++which)
    if (isInView(positionOf(expected, which), offOf(expected, which)) && !isHidden(expected, which))
      found.push_back(static_cast<size_t>(which));
  return found;
}

bool LandmarkSensor::isInView(const Vector2d& position, double off) const {
  const double range = position.norm(), direction = std::abs(std::atan2(position.y(), position.x()));
  if (range + off > params_.max_range || range - off < params_.min_range || off > range) return false;
  if (params_.field_of_view >= 2 * M_PI) return true;
  return direction + std::asin(off / range) < params_.field_of_view / 2;
}

bool LandmarkSensor::isHidden(const SightingPrediction& expected, Index which) const {
  const Vector2d position = positionOf(expected, which), ahead = position.normalized();
  for (Index k = 0; k < expected.positions.size() / 2; ++k) {
    const Vector2d other = positionOf(expected, k);
    const double along = other.dot(ahead), aside = std::abs(other.x() * ahead.y() - other.y() * ahead.x());
    if (k != which && along > 0 && along < position.norm() && aside < params_.width + offOf(expected, k))
      return true;
  }
  return false;
}

double LandmarkSensor::evidence(bool is_seen) const {
  return is_seen ? std::log(params_.detection / params_.phantom)
                 : std::log((1 - params_.detection) / (1 - params_.phantom));
}

}  // namespace sextant
