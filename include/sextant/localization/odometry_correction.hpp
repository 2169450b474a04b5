// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/localization/pose_hypotheses.hpp"

namespace sextant {

/// How odometry drifts (as driftVariance(), the same on all three axes: in space it is height, roll and
/// pitch, too, that wheels do not measure), and what is made of poses that contradict it.
struct OdometryParams {
  double position_drift = 0.05;
  double heading_drift = 0.02;
  double turn_drift = 0.05;
  double gate = 40.0;
  int recovery = 5;

  ParamList fields();
};

/// A pose after a step (T_last_base) that odometry measured, with what the step may have drifted added.
PosePrior movedByOdometry(const PosePrior& pose, const Pose& step, const OdometryParams& params);

/// Keeps T_map_odom: the last pose in the map, moved by odometry and corrected by every pose that does not
/// contradict it (an extended Kalman filter over (position, rotation) in the map's axes).
class OdometryCorrection {
 public:
  /// What became of a pose.
  enum class Verdict { taken, recovered, contradicts };

  /// @throws std::invalid_argument as validate(OdometryParams).
  explicit OdometryCorrection(const OdometryParams& params);

  /// Keeps what is known. @throws as the constructor, and changes nothing then
  void setParams(const OdometryParams& params);

  /// Where the base should be; nothing before the first pose.
  std::optional<PosePrior> predict(const Pose& T_odom_base) const;

  /// Whether a pose is beyond the gate; false before the first one.
  bool contradicts(const Pose& T_odom_base, const Pose& T_map_base, const Matrix6d& covariance) const;

  /// recovered: it was the odometry (or the first pose) that was wrong, and all is begun anew from here.
  /// contradicts: the pose was not used.
  Verdict update(const Pose& T_odom_base, const Pose& T_map_base, const Matrix6d& covariance);

  /// T_map_odom; nothing before the first pose.
  std::optional<Pose> transform() const;

  void reset();

 private:
  struct State {
    Pose T_odom_base, T_map_base;
    Matrix6d covariance;
  };
  PosePrior moved(const State& state, const Pose& T_odom_base) const;
  bool apart(const PosePrior& expected, const Pose& T_map_base, const Matrix6d& covariance) const;
  Verdict refuse(const State& measured);

  OdometryParams params_;
  std::optional<State> state_;
  std::optional<State> refused_;  // the last pose that contradicted
  int refusals_ = 0;              // in a row, in agreement with one another
};

}  // namespace sextant
