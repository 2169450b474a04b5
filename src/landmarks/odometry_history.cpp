// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/odometry_history.hpp"

#include <algorithm>
#include <iterator>

namespace sextant {

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
