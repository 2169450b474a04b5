// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/lens_correction.hpp"

#include <cmath>

namespace sextant {
namespace {

constexpr int kGrid = 10;  // points along each side of the image

}  // namespace

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

RecordedInstant correctedInstant(RecordedInstant instant, const LensCorrections& lenses) {
  for (MarkerView& view : instant.views) {
    const auto lens = lenses.find(view.camera_index);
    if (lens == lenses.end()) continue;
    for (Detection& detection : view.detections)
      detection.corners = correctedCorners(view.camera, detection.corners, lens->second);
  }
  return instant;
}

double lensDisplacement(const CameraModel& camera, const LensCorrection& lens) {
  double squares = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const Eigen::Vector2d share(i % kGrid + 0.5, i / kGrid + 0.5);
    const Eigen::Vector2d pixel =
        share.cwiseProduct(Eigen::Vector2d(camera.width(), camera.height())) / kGrid;
    squares += (lensModes(camera, pixel) * lens).squaredNorm();
  }
  return std::sqrt(squares) / kGrid;
}

}  // namespace sextant
