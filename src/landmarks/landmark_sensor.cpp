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

constexpr double kViewDeviations = 3.0;  // tolerated errors of robot and landmarks
constexpr double kNewView = 0.2;         // motion over distance at which the direction is another one
constexpr double kPriorWeight = 20;      // counted landmarks that weigh as much as the parameter
constexpr double kLeast = 0.01;          // bounds of the detection probability: it and 1 minus it
constexpr double kLeastRatio = 1.5;      // of detections over false alarms

Vector2d positionOf(const ObservationPrediction& expected, Index which) {
  return expected.positions.segment<2>(2 * which);
}

double offOf(const ObservationPrediction& expected, Index which) {
  return kViewDeviations * largestDeviation(expected.covariance.block<2, 2>(2 * which, 2 * which));
}

}  // namespace

double largestDeviation(const Eigen::Matrix2d& covariance) {
  return std::sqrt(std::max(0.0, covariance.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff()));
}

bool isNewView(const Vector2d& last, const Vector2d& from, const Vector2d& landmark) {
  return (last - from).norm() > kNewView * (landmark - from).norm();
}

ParamList LandmarkSensorParams::fields() {
  return {
      {"max_range", &max_range, Range::openLow(0, 1000), "m",
       "maximum range at which the sensor detects reliably"},
      {"min_range", &min_range, Allowed(Range::closed(0, max_range), "[0, `max_range`]"), "m",
       "minimum range at which the sensor detects reliably"},
      {"field_of_view", &field_of_view, Allowed(Range::openLow(0, 2 * M_PI), "(0, 2π]"), "rad",
       "horizontal angle in which the sensor detects reliably, centred on the x axis of the frame of the "
       "observations, or on the optical axis of a camera"},
      {"detection_probability", &detection_probability, Range::closed(0.01, 0.99), "",
       "probability that the sensor detects a landmark in view; corrected by the detections"},
      {"false_alarm_probability", &false_alarm_probability, Range::closed(0.001, 0.5), "",
       "probability that an observation is a false alarm"},
      {"landmark_width", &landmark_width, Range::closed(0, 100), "m",
       "width of a landmark, which occludes what is behind it"},
      {"min_separation", &min_separation, Range::closed(0, 100), "m",
       "minimum distance between two landmarks of a class; two that are closer are merged"},
  };
}

LandmarkSensor::LandmarkSensor(const LandmarkSensorParams& params) : params_(params) { validate(params); }

std::vector<size_t> LandmarkSensor::expectedInView(const ObservationPrediction& in_base,
                                                   const Pose2& T_base_sensor) const {
  ObservationPrediction expected = in_base;  // the largest standard deviations do not depend on the frame
  const Pose2 T_sensor_base = T_base_sensor.inverse();
  for (Index which = 0; which < expected.positions.size() / 2; ++which)
    expected.positions.segment<2>(2 * which) = T_sensor_base * positionOf(in_base, which);
  std::vector<size_t> found;
  for (Index which = 0; which < expected.positions.size() / 2; ++which)
    if (isInView(positionOf(expected, which), offOf(expected, which)) && !isOccluded(expected, which))
      found.push_back(static_cast<size_t>(which));
  return found;
}

bool LandmarkSensor::isInView(const Vector2d& position, double off) const {
  const double range = position.norm(), direction = std::abs(std::atan2(position.y(), position.x()));
  if (range + off > params_.max_range || range - off < params_.min_range || off > range) return false;
  if (params_.field_of_view >= 2 * M_PI) return true;
  return direction + std::asin(off / range) < params_.field_of_view / 2;
}

bool LandmarkSensor::isOccluded(const ObservationPrediction& expected, Index which) const {
  const Vector2d position = positionOf(expected, which), ahead = position.normalized();
  for (Index k = 0; k < expected.positions.size() / 2; ++k) {
    const Vector2d other = positionOf(expected, k);
    const double along = other.dot(ahead), aside = std::abs(other.x() * ahead.y() - other.y() * ahead.x());
    if (k != which && along > 0 && along < position.norm() &&
        aside < params_.landmark_width + offOf(expected, k))
      return true;
  }
  return false;
}

double LandmarkSensor::evidence(bool is_detected) const {
  // A detection that is as probable as a false alarm would be no evidence.
  const double detection = std::max(detectionProbability(), kLeastRatio * params_.false_alarm_probability);
  return is_detected ? std::log(detection / params_.false_alarm_probability)
                     : std::log((1 - detection) / (1 - params_.false_alarm_probability));
}

void LandmarkSensor::count(int detected, int missed) {
  detected_ += detected;
  expected_ += detected + missed;
}

/// Mean of a beta distribution whose prior has the weight of kPriorWeight counted landmarks.
double LandmarkSensor::detectionProbability() const {
  const double prior = params_.detection_probability;
  return std::clamp((kPriorWeight * prior + detected_) / (kPriorWeight + expected_), kLeast, 1 - kLeast);
}

}  // namespace sextant
