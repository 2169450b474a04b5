// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose2.hpp"

namespace sextant {

/// Noise of a step of wheel odometry in the plane, as driftVariance().
struct OdometryNoiseParams {
  double turn_by_turn = 0.05;
  double turn_by_way = 0.02;
  double way_by_way = 0.03;
  double way_by_turn = 0.01;
  double aside_by_way = 0.01;

  ParamList fields();
};

/// T_last_base, and the covariance of (x, y, heading) that is felt where the step begins: X' = X exp(w) step.
struct OdometryStep {
  Pose2 step;
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
  double way = 0;  ///< metres, that were gone on it

  /// This step and another one after it.
  OdometryStep operator*(const OdometryStep& next) const;
};

/// A small step. @param step T_last_base
OdometryStep noisyStep(const Pose2& step, const OdometryNoiseParams& params);

/// What odometry said lately.
class OdometryHistory {
 public:
  /// @param span seconds that are kept, before the last reading but one
  OdometryHistory(const OdometryNoiseParams& params, double span) : params_(params), span_(span) {}

  /// @param stamp seconds
  /// @returns whether it was taken: it is newer than all before
  bool add(double stamp, const Pose2& T_odom_base);

  /// From one moment to a later one, positions between two readings on the straight line; nothing where one
  /// of them lies outside of what is kept.
  std::optional<OdometryStep> between(double from, double to) const;

  std::optional<Pose2> at(double stamp) const;  ///< T_odom_base
  bool empty() const { return readings_.empty(); }
  double first() const { return readings_.front().stamp; }
  double last() const { return readings_.back().stamp; }
  void clear() { readings_.clear(); }

 private:
  struct Reading {
    double stamp;
    Pose2 T_odom_base;
  };
  using Readings = std::deque<Reading>;
  Readings::const_iterator after(double stamp) const;

  OdometryNoiseParams params_;
  double span_;
  Readings readings_;
};

}  // namespace sextant
