// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "edge_curve.hpp"

#include <Eigen/LU>
#include <cmath>

namespace sextant {

EdgeCurve::EdgeCurve(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, bool normal_on_the_left)
    : middle(0.5 * (begin + end)), half(0.5 * (end - begin)) {
  normal = Eigen::Vector2d(half.y(), -half.x()) / half.norm();
  if (!normal_on_the_left) normal = -normal;
}

bool EdgeCurve::followLens(const CameraModel& camera) {
  const auto begin = camera.unproject(middle - half), end = camera.unproject(middle + half);
  if (!begin || !end) return false;
  const double square = half.squaredNorm();
  std::array<double, 3> s, bow;
  for (int i = 0; i < 3; ++i) {
    const double share = 0.25 * (i + 1);
    const auto pixel = camera.project((1 - share) * *begin + share * *end);
    if (!pixel) return false;
    s[i] = half.dot(*pixel - middle) / square;
    bow[i] = normal.dot(*pixel - middle) / (1 - s[i] * s[i]);
  }
  // Newton's divided differences of bow(s), expanded to monomials.
  const double d01 = (bow[1] - bow[0]) / (s[1] - s[0]), d12 = (bow[2] - bow[1]) / (s[2] - s[1]);
  const double q2 = (d12 - d01) / (s[2] - s[0]);
  const double q1 = d01 - q2 * (s[0] + s[1]);
  const double q0 = bow[0] - s[0] * (d01 - q2 * s[1]);
  const std::array<double, 5> lens = {q0, q1, q2 - q0, -q1, -q2};
  for (int k = 0; k < 5; ++k) c[k] += lens[k];
  return true;
}

void EdgeCurve::bend(double c2) { c = {-c2, 0, c2, 0, 0}; }

std::optional<Eigen::Vector2d> intersect(const EdgeCurve& a, const EdgeCurve& b) {
  constexpr int kMaxSteps = 8;
  constexpr double kFarthest = 2;  // half chords
  double s = 1, t = -1;
  for (int i = 0; i < kMaxSteps; ++i) {
    Eigen::Matrix2d J;
    J << a.tangent(s), -b.tangent(t);
    const Eigen::Vector2d step = J.inverse() * (b.at(t) - a.at(s));
    s += step[0];
    t += step[1];
    if (!(std::abs(s) < kFarthest) || !(std::abs(t) < kFarthest)) return std::nullopt;
    if (step.squaredNorm() < 1e-12) return a.at(s);
  }
  return std::nullopt;
}

}  // namespace sextant
