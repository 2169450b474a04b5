// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/odometry_noise.hpp"

#include <cmath>

#include "sextant/geometry/odometry_drift.hpp"

namespace sextant {

using Eigen::Matrix3d;

ParamList OdometryNoiseParams::fields() {
  const Range range = Range::closed(0, 10);
  return {
      {"rotation_from_rotation", &rotation_from_rotation, range, "rad",
       "[odometry](../how_to/landmarks.md#odometry-noise): standard deviation of the heading after 1 rad, "
       "growing with the square root of the angle; the next four also grow with the square root of angle or "
       "distance"},
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
  return {step, variances.asDiagonal(), distance, step.heading};
}

// exp(w1) U1 exp(w2) U2 = exp(w1) exp(Ad(U1) w2) U1 U2
OdometryStep OdometryStep::operator*(const OdometryStep& next) const {
  Matrix3d Ad = Matrix3d::Identity();
  Ad.topLeftCorner<2, 2>() = rotation2(step.heading);
  Ad.topRightCorner<2, 1>() = -perpendicular(step.position);
  return {step * next.step, noise + Ad * next.noise * Ad.transpose(), distance + next.distance,
          turn + next.turn};
}

}  // namespace sextant
