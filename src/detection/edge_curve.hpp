// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "sextant/geometry/camera.hpp"

namespace sextant {

/// The image of a straight edge: a chord plus the deviation by lens distortion,
/// offset(s) = sum of c[k] s^k, pixels along the normal, with s from -1 (begin) to 1 (end) along the chord.
struct EdgeCurve {
  /// @param normal_on_the_left whether the normal points to the left of the direction from begin to end (y
  /// down)
  EdgeCurve(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, bool normal_on_the_left);

  double length() const { return 2 * half.norm(); }
  double offset(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4]))); }
  /// Derivative of the offset.
  double slope(double s) const { return c[1] + s * (2 * c[2] + s * (3 * c[3] + s * 4 * c[4])); }
  Eigen::Vector2d at(double s) const { return middle + s * half + offset(s) * normal; }
  Eigen::Vector2d tangent(double s) const { return half + slope(s) * normal; }

  /// Makes the curve the image of the straight line in space between its chord's ends: adds (1 - s^2) times a
  /// parabola through the deviations of three points.
  /// @return false, without a change, if the lens model has no ray for the chord
  bool followLens(const CameraModel& camera);
  /// Bends the curve to the parabola with this c[2] through the chord's ends.
  void bend(double c2);

  Eigen::Vector2d middle;     ///< pixels
  Eigen::Vector2d half;       ///< from the middle to the end, pixels
  Eigen::Vector2d normal;     ///< unit vector
  std::array<double, 5> c{};  ///< coefficients of the offset, pixels
};

/// Intersects the end of a with the beginning of b by Newton's method on a(s) = b(t). Returns nothing if they
/// do not intersect there.
std::optional<Eigen::Vector2d> intersect(const EdgeCurve& a, const EdgeCurve& b);

}  // namespace sextant
