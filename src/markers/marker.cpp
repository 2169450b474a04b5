// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker.hpp"

#include <algorithm>
#include <limits>

namespace sextant {

std::array<Eigen::Vector3d, 4> markerCorners(double size) {
  const double h = 0.5 * size;
  return {Eigen::Vector3d(-h, h, 0), {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
}

Eigen::Vector2d centre(const Corners& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

double perimeter(const Corners& corners) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += (corners[i] - corners[(i + 1) % 4]).norm();
  return sum;
}

double shortestSide(const Corners& corners) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4; ++i) least = std::min(least, (corners[i] - corners[(i + 1) % 4]).norm());
  return least;
}

}  // namespace sextant
