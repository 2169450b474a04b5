// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/odometry_history.hpp"

#include <algorithm>
#include <cmath>

#include "sextant/geometry/odometry_drift.hpp"

namespace sextant {

using Eigen::Matrix3d;

ParamList OdometryNoiseParams::fields() {
  const Range range = Range::closed(0, 10);
  return {
      {"rotation_from_rotation", &rotation_from_rotation, range, "rad",
       "[odometry](../how_to/landmarks.md#odometry-noise): standard deviation of the heading after 1 rad, "
       "growing with the root of the angle; the next four also grow with the root of angle or distance"},
      {"rotation_from_translation", &rotation_from_translation, range, "rad",
       "standard deviation of the heading after 1 m"},
      {"translation_from_translation", &translation_from_translation, range, "m",
       "standard deviation along x after 1 m"},
      {"translation_from_rotation", &translation_from_rotation, range, "m",
       "standard deviation along x after 1 rad"},
      {"lateral_from_translation", &lateral_from_translation, range, "m",
       "standard deviation along y after 1 m"},
  };
}

OdometryStep noisyStep(const Pose2& step, const OdometryNoiseParams& params) {
  const double distance = step.position.norm(), turn = std::abs(step.heading);
  const Eigen::Vector3d variances(
      driftVariance(params.translation_from_translation, params.translation_from_rotation, distance, turn),
      driftVariance(params.lateral_from_translation, 0, distance, turn),
      driftVariance(params.rotation_from_translation, params.rotation_from_rotation, distance, turn));
  return {step, variances.asDiagonal(), distance};
}

// exp(w1) U1 exp(w2) U2 = exp(w1) exp(Ad(U1) w2) U1 U2
OdometryStep OdometryStep::operator*(const OdometryStep& next) const {
  Matrix3d Ad = Matrix3d::Identity();
  Ad.topLeftCorner<2, 2>() = rotation2(step.heading);
  Ad.topRightCorner<2, 1>() = -perpendicular(step.position);
  return {step * next.step, noise + Ad * next.noise * Ad.transpose(), distance + next.distance};
}

bool OdometryHistory::add(double stamp, const Pose2& T_odom_base) {
  if (!readings_.empty() && stamp <= readings_.back().stamp) return false;
  // The span ends at the last reading, not at the new one: the motion during a pause needs the reading before
  // it.
  while (readings_.size() > 2 && readings_[1].stamp < readings_.back().stamp - span_) readings_.pop_front();
  readings_.push_back({stamp, T_odom_base});
  return true;
}

OdometryHistory::Readings::const_iterator OdometryHistory::after(double stamp) const {
  return std::upper_bound(readings_.begin(), readings_.end(), stamp,
                          [](double value, const Reading& reading) { return value < reading.stamp; });
}

std::optional<Pose2> OdometryHistory::at(double stamp) const {
  if (empty() || stamp < first() || stamp > last()) return {};
  if (stamp == last()) return readings_.back().T_odom_base;
  const auto next = after(stamp), before = std::prev(next);
  const double part = (stamp - before->stamp) / (next->stamp - before->stamp);
  const Pose2 step = before->T_odom_base.inverse() * next->T_odom_base;
  return before->T_odom_base * Pose2{part * step.position, part * step.heading};
}

std::optional<OdometryStep> OdometryHistory::between(double from, double to) const {
  const std::optional<Pose2> begin = at(from), end = at(to);
  if (!begin || !end) return {};
  OdometryStep whole;
  Pose2 last = *begin;
  for (auto reading = after(from); reading != readings_.end() && reading->stamp < to; ++reading) {
    whole = whole * noisyStep(last.inverse() * reading->T_odom_base, params_);
    last = reading->T_odom_base;
  }
  return whole * noisyStep(last.inverse() * *end, params_);
}

}  // namespace sextant
