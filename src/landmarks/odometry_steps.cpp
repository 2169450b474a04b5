// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/odometry_steps.hpp"

#include <algorithm>
#include <cmath>

#include "sextant/geometry/odometry_drift.hpp"

namespace sextant {

using Eigen::Matrix3d;

ParamList OdometryNoiseParams::fields() {
  const Range range = Range::closed(0, 10);
  return {
      {"turn_by_turn", &turn_by_turn, range, "rad",
       "[odometry](landmarks.md#how-good-odometry-is): deviation of the heading after 1 rad, growing with "
       "the root; so are the next four"},
      {"turn_by_way", &turn_by_way, range, "rad", "of the heading after 1 m"},
      {"way_by_way", &way_by_way, range, "m", "along x after 1 m"},
      {"way_by_turn", &way_by_turn, range, "m", "along x after 1 rad"},
      {"aside_by_way", &aside_by_way, range, "m", "along y after 1 m"},
  };
}

OdometryStep noisyStep(const Pose2& step, const OdometryNoiseParams& params) {
  const double way = step.position.norm(), turn = std::abs(step.heading);
  const Eigen::Vector3d variances(driftVariance(params.way_by_way, params.way_by_turn, way, turn),
                                  driftVariance(params.aside_by_way, 0, way, turn),
                                  driftVariance(params.turn_by_way, params.turn_by_turn, way, turn));
  return {step, variances.asDiagonal(), way};
}

// exp(w1) U1 exp(w2) U2 = exp(w1) exp(Ad(U1) w2) U1 U2
OdometryStep OdometryStep::operator*(const OdometryStep& next) const {
  Matrix3d Ad = Matrix3d::Identity();
  Ad.topLeftCorner<2, 2>() = rotation2(step.heading);
  Ad.topRightCorner<2, 1>() = -turnedLeft(step.position);
  return {step * next.step, noise + Ad * next.noise * Ad.transpose(), way + next.way};
}

bool OdometryHistory::add(double stamp, const Pose2& T_odom_base) {
  if (!readings_.empty() && stamp <= readings_.back().stamp) return false;
  // Not of the new one: what came before a pause is needed to tell what was gone in it.
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
