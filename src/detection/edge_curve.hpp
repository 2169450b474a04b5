// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "sextant/geometry/camera.hpp"

namespace sextant {

/// The image of a straight edge: a chord, and what a lens bends away from it.
/// offset(s) = sum of c[k] s^k, pixels along the normal, with s from -1 (begin) to 1 (end) along the chord.
struct EdgeCurve {
  /// @param normal_on_the_left as one walks from begin to end with y down; else it points to the right
  EdgeCurve(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, bool normal_on_the_left);

  double length() const { return 2 * half.norm(); }
  double offset(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4]))); }
  double slope(double s) const { return c[1] + s * (2 * c[2] + s * (3 * c[3] + s * 4 * c[4])); }
  Eigen::Vector2d at(double s) const { return middle + s * half + offset(s) * normal; }
  Eigen::Vector2d tangent(double s) const { return half + slope(s) * normal; }

  /// Adds bow to the curve so that it becomes the image of the straight line in space between its chord's
  /// ends: (1 - s^2) times the parabola through what three points between them are off.
  /// @return false (and no change) where the lens model has no ray for the chord
  bool followLens(const CameraModel& camera);
  /// Bends the curve to the parabola with this c[2] through the chord's ends.
  void bend(double c2);

  Eigen::Vector2d middle;  ///< pixels
  Eigen::Vector2d half;    ///< from the middle to the end, pixels
  Eigen::Vector2d normal;  ///< unit vector
  std::array<double, 5> c{};
};

/// Where a ends and b begins, by Newton's method on a(s) = b(t); nothing where they do not meet near there.
std::optional<Eigen::Vector2d> intersect(const EdgeCurve& a, const EdgeCurve& b);

}  // namespace sextant
