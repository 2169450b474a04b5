// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/localization/pose_hypotheses.hpp"

namespace sextant {

/// Noise of odometry (see driftVariance(); the same for all three axes, because wheels do not measure height,
/// roll and pitch), and the gate for poses that contradict it.
struct OdometryParams {
  double position_drift = 0.05;
  double heading_drift = 0.02;
  double turn_drift = 0.05;
  double gate = 40.0;
  int max_rejections = 5;

  ParamList fields();
};

/// Predicts the pose after an odometry step: moves it, and adds the drift of the step to its covariance.
/// @param step pose of the base after the step in its frame before the step
PosePrior movedByOdometry(const PosePrior& pose, const Pose& step, const OdometryParams& params);

/// Estimates T_map_odom with an extended Kalman filter over (position, rotation) in the map's axes: odometry
/// predicts the pose in the map, and every pose within the gate corrects it.
class OdometryCorrection {
 public:
  /// Result of an update: accepted; recovered: the filter restarted from the pose; rejected: not used.
  enum class Verdict { accepted, recovered, rejected };

  /// @throws std::invalid_argument as validate(OdometryParams).
  explicit OdometryCorrection(const OdometryParams& params);

  /// Changes the parameters and keeps the state. @throws as the constructor, without any change
  void setParams(const OdometryParams& params);

  /// Predicts the pose of the base; nothing before the first pose.
  std::optional<PosePrior> predict(const Pose& T_odom_base) const;

  /// Whether a pose is outside the gate around the prediction; false before the first pose.
  bool contradicts(const Pose& T_odom_base, const Pose& T_map_base, const Matrix6d& covariance) const;

  /// Corrects the prediction with a pose. After max_rejections consecutive rejected poses that are consistent
  /// with each other, odometry (or the first pose) was wrong: the filter restarts from the last of them.
  Verdict update(const Pose& T_odom_base, const Pose& T_map_base, const Matrix6d& covariance);

  /// T_map_odom; nothing before the first pose.
  std::optional<Pose> transform() const;

  /// Number of times that the filter has started: from its first pose, from the first one after reset(), and
  /// after odometry was wrong.
  int starts() const { return starts_; }

  void reset();  ///< forgets all poses

 private:
  struct State {
    Pose T_odom_base, T_map_base;
    Matrix6d covariance;
  };
  PosePrior predictFrom(const State& state, const Pose& T_odom_base) const;
  bool isOutsideGate(const PosePrior& predicted, const Pose& T_map_base, const Matrix6d& covariance) const;
  Verdict reject(const State& measured);
  void start(const State& measured);

  OdometryParams params_;
  std::optional<State> state_;
  std::optional<State> rejected_;  // the last rejected pose
  int rejections_ = 0;             // number of consecutive rejected poses, consistent with each other
  int starts_ = 0;
};

}  // namespace sextant
