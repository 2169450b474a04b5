// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

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
  double turn = 0;                                  ///< radians turned, not wrapped

  /// Composes two successive steps.
  OdometryStep operator*(const OdometryStep& next) const;
};

/// Adds the noise of odometry to a short step. @param step T_last_base
OdometryStep noisyStep(const Pose2& step, const OdometryNoiseParams& params);

}  // namespace sextant
