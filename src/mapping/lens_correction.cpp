// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/lens_correction.hpp"

#include <cmath>

namespace sextant {

Eigen::Matrix<double, 2, kLensModes> lensModes(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d size(camera.width(), camera.height());
  const Eigen::Vector2d n = (2 * pixel - size) / size.norm();
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  Eigen::Matrix<double, 2, kLensModes> modes;
  modes << 1, 0, x, 0, x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x,  //
      0, 1, 0, y, y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y;
  return modes;
}

Corners correctedCorners(const CameraModel& camera, const Corners& corners, const LensCorrection& lens) {
  Corners corrected = corners;
  for (Eigen::Vector2d& corner : corrected) corner -= lensModes(camera, corner) * lens;
  return corrected;
}

}  // namespace sextant
