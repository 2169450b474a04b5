// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sextant/geometry/eigen_solvers.hpp"

namespace sextant {

/// Counter-clockwise rotation by an angle, radians.
Eigen::Matrix2d rotation2(double angle);

/// A rotation's angle times its axis, in the plane: cross(a) b = a (-b_y, b_x).
Eigen::Vector2d turnedLeft(const Eigen::Vector2d& vector);

/// The angle in (-pi, pi].
double wrapped(double angle);

/// T_a_b in the plane: takes coordinates in frame b to coordinates in frame a.
struct Pose2 {
  Eigen::Vector2d position{0, 0};  ///< metres
  double heading = 0;              ///< radians

  Pose2 operator*(const Pose2& other) const;  ///< T_a_c = T_a_b T_b_c
  Eigen::Vector2d operator*(const Eigen::Vector2d& point) const;
  Pose2 inverse() const;
  bool operator==(const Pose2& other) const { return position == other.position && heading == other.heading; }
};

/// sin(x) / x and (1 - cos(x)) / x as a matrix: exp of (v, angle) in SE(2) moves by leftJacobian2(angle) v.
Eigen::Matrix2d leftJacobian2(double angle);

}  // namespace sextant
