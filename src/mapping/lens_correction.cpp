// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/lens_correction.hpp"

#include <cmath>

namespace sextant {
namespace {

constexpr int kGrid = 10;   // points along each side of the image
constexpr int kRounds = 3;  // of the fixed-point iteration; a displacement varies little over its own length

// Relative to the centre of the image, in units of half its diagonal.
Eigen::Vector2d normalized(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d size(camera.width(), camera.height());
  return (2 * pixel - size) / size.norm();
}

}  // namespace

Eigen::Matrix<double, 2, kLensModes> lensModes(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d n = normalized(camera, pixel);
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  Eigen::Matrix<double, 2, kLensModes> modes;
  modes << 1, 0, x, 0, x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x,  //
      0, 1, 0, y, y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y;
  return modes;
}

Eigen::Matrix2d lensJacobian(const CameraModel& camera, const Eigen::Vector2d& pixel,
                             const LensCorrection& lens) {
  const Eigen::Vector2d n = normalized(camera, pixel);
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  const double radial = lens[4] * r2 + lens[5] * r2 * r2, slope = lens[4] + 2 * lens[5] * r2;
  const double both = 2 * (x * y * slope + x * lens[6] + y * lens[7]);
  Eigen::Matrix2d jacobian;
  jacobian << lens[2] + radial + 2 * x * x * slope + 2 * y * lens[6] + 6 * x * lens[7], both,  //
      both, lens[3] + radial + 2 * y * y * slope + 6 * y * lens[6] + 2 * x * lens[7];
  return 2 * jacobian / Eigen::Vector2d(camera.width(), camera.height()).norm();
}

Corners correctedCorners(const CameraModel& camera, const Corners& corners, const LensCorrection& lens) {
  Corners corrected = corners;
  for (size_t k = 0; k < corners.size(); ++k)
    for (int round = 0; round < kRounds; ++round)
      corrected[k] = corners[k] - lensModes(camera, corrected[k]) * lens;
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
