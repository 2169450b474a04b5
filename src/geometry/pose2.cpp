// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/pose2.hpp"

#include <cmath>

namespace sextant {

Eigen::Matrix2d rotation2(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

Eigen::Vector2d perpendicular(const Eigen::Vector2d& vector) { return {-vector.y(), vector.x()}; }

double wrapped(double angle) {
  const double rest = std::remainder(angle, 2 * M_PI);  // in [-pi, pi]
  return rest <= -M_PI ? M_PI : rest;
}

Pose2 Pose2::operator*(const Pose2& other) const {
  return {*this * other.position, wrapped(heading + other.heading)};
}

Eigen::Vector2d Pose2::operator*(const Eigen::Vector2d& point) const {
  return position + rotation2(heading) * point;
}

Pose2 Pose2::inverse() const { return {-(rotation2(-heading) * position), -heading}; }

Eigen::Vector3d difference(const Pose2& a, const Pose2& b) {
  return {a.position.x() - b.position.x(), a.position.y() - b.position.y(), wrapped(a.heading - b.heading)};
}

Eigen::Matrix2d leftJacobian2(double angle) {
  constexpr double kSmall = 1e-4;  // below it the next term of the series is less than the rounding error
  const bool small = std::abs(angle) < kSmall;
  const double a = small ? 1 - angle * angle / 6 : std::sin(angle) / angle;
  const double b = small ? angle / 2 : (1 - std::cos(angle)) / angle;
  return (Eigen::Matrix2d() << a, -b, b, a).finished();
}

}  // namespace sextant
