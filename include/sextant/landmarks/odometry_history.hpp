// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose2.hpp"

namespace sextant {

/// Noise of planar wheel odometry, as driftVariance().
struct OdometryNoiseParams {
  double rotation_from_rotation = 0.05;
  double rotation_from_translation = 0.02;
  double translation_from_translation = 0.03;
  double translation_from_rotation = 0.01;
  double lateral_from_translation = 0.01;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// A motion of the robot with noise w in the frame at its beginning: X' = X exp(w) step.
struct OdometryStep {
  Pose2 step;                                       ///< T_last_base
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();  ///< covariance of w: (x, y, heading)
  double distance = 0;                              ///< metres driven

  /// Composes two successive steps.
  OdometryStep operator*(const OdometryStep& next) const;
};

/// Adds the noise of odometry to a short step. @param step T_last_base
OdometryStep noisyStep(const Pose2& step, const OdometryNoiseParams& params);

/// Recent odometry readings.
class OdometryHistory {
 public:
  /// @param span seconds of readings that are kept before the last but one
  OdometryHistory(const OdometryNoiseParams& params, double span) : params_(params), span_(span) {}

  /// Adds a reading. @param stamp seconds @returns false if it is not newer than the last one; it is ignored
  /// then
  bool add(double stamp, const Pose2& T_odom_base);

  /// Motion between two stamps, interpolated linearly between readings; nothing if one of them is outside of
  /// the readings that are kept.
  std::optional<OdometryStep> between(double from, double to) const;

  std::optional<Pose2> at(double stamp) const;              ///< T_odom_base, interpolated
  bool empty() const { return readings_.empty(); }          ///< whether there is no reading
  double first() const { return readings_.front().stamp; }  ///< oldest stamp, seconds
  double last() const { return readings_.back().stamp; }    ///< newest stamp, seconds
  void clear() { readings_.clear(); }                       ///< removes all readings

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
