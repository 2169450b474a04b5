// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sextant/geometry/eigen_solvers.hpp"

namespace sextant {

/// Returns the rotation matrix of a counter-clockwise angle, radians.
Eigen::Matrix2d rotation2(double angle);

/// Rotates a vector by 90 degrees counter-clockwise: (-y, x), its derivative with respect to a rotation
/// angle.
Eigen::Vector2d perpendicular(const Eigen::Vector2d& vector);

/// Returns the equivalent angle in (-pi, pi].
double wrapped(double angle);

/// A pose in the plane. T_a_b is the pose of frame b in frame a: p_a = T_a_b p_b.
struct Pose2 {
  Eigen::Vector2d position{0, 0};  ///< metres
  double heading = 0;              ///< radians

  Pose2 operator*(const Pose2& other) const;                      ///< T_a_c = T_a_b T_b_c
  Eigen::Vector2d operator*(const Eigen::Vector2d& point) const;  ///< p_a = T_a_b p_b
  Pose2 inverse() const;                                          ///< T_b_a
  /// Exact comparison.
  bool operator==(const Pose2& other) const { return position == other.position && heading == other.heading; }
};

/// Returns (x, y, heading) of a minus that of b, both in the same frame; the heading is wrapped.
Eigen::Vector3d difference(const Pose2& a, const Pose2& b);

/// Returns the left Jacobian of SE(2): exp(v, angle) translates by leftJacobian2(angle) v. With x = angle,
/// its elements are sin(x) / x and +-(1 - cos(x)) / x.
Eigen::Matrix2d leftJacobian2(double angle);

}  // namespace sextant
