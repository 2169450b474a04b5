// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "module_grid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "edge_fit.hpp"

namespace sextant {
namespace {

constexpr int kMaxSteps = 48;
constexpr int kStepsABit = 2;
constexpr double kBitContrast = 0.5;  // minimum contrast of a bit over that of the edge
constexpr double kBitReach = 0.6;     // modules

// Homography from the unit square to a quadrangle; Heckbert 1989, "Fundamentals of texture mapping and image
// warping", 2.2.3.
Eigen::Matrix3d squareToQuad(const Eigen::Vector2d& p0, const Eigen::Vector2d& p1, const Eigen::Vector2d& p2,
                             const Eigen::Vector2d& p3) {
  const Eigen::Vector2d d1 = p1 - p2, d2 = p3 - p2, sum = p0 - p1 + p2 - p3;
  const double determinant = d1.x() * d2.y() - d2.x() * d1.y();
  const double g = (sum.x() * d2.y() - d2.x() * sum.y()) / determinant;
  const double h = (d1.x() * sum.y() - sum.x() * d1.y()) / determinant;
  Eigen::Matrix3d H;
  H.topLeftCorner<2, 1>() = p1 - p0 + g * p1;
  H.block<2, 1>(0, 1) = p3 - p0 + h * p3;
  H.topRightCorner<2, 1>() = p0;
  H.row(2) << g, h, 1;
  return H;
}

// Deviation of a curve from its chord at the point nearest to a pixel.
Eigen::Vector2d bow(const EdgeCurve& curve, const Eigen::Vector2d& pixel) {
  const double s = curve.half.dot(pixel - curve.middle) / curve.half.squaredNorm();
  return curve.offset(s) * curve.normal;
}

}  // namespace

ModuleGrid::ModuleGrid(const Corners& corners, int side, int modules, const EdgeCurve& near,
                       const EdgeCurve& far)
    : near_(near), far_(far), modules_(modules) {
  H_ = squareToQuad(corners[side], corners[(side + 1) % 4], corners[(side + 2) % 4], corners[(side + 3) % 4]);
}

Eigen::Vector2d ModuleGrid::flat(double u, double v) const {
  return (H_ * Eigen::Vector3d(u, v, 1)).hnormalized();
}

Eigen::Vector2d ModuleGrid::at(double u, double v) const {
  return flat(u, v) + (1 - v) * bow(near_, flat(u, 0)) + v * bow(far_, flat(u, 1));
}

std::optional<double> ModuleGrid::lineOffset(const cv::Mat& image, int line, double contrast) const {
  const double v = static_cast<double>(line) / modules_;
  const double module = (at(0.5, v + 0.5 / modules_) - at(0.5, v - 0.5 / modules_)).norm();
  const double reach = std::clamp(kBitReach * module, 1.2, 8.0);
  std::array<double, kMaxSteps> offsets;
  int count = 0;
  for (int bit = 1; bit < modules_ - 1; ++bit)
    for (int k = 0; k < kStepsABit && count < kMaxSteps; ++k) {
      const Eigen::Vector2d point = at((bit + (k + 0.5) / kStepsABit) / modules_, v);
      if (const auto offset = stepOffset(image, near_, point, reach, kBitContrast * contrast))
        offsets[count++] = *offset;
    }
  if (count < kStepsABit) return std::nullopt;
  std::nth_element(offsets.begin(), offsets.begin() + count / 2, offsets.begin() + count);
  return offsets[count / 2];
}

std::optional<double> ModuleGrid::bitOffset(const cv::Mat& image, double contrast) const {
  for (int line = 1; line <= modules_ - 2; ++line)
    if (const auto offset = lineOffset(image, line, contrast)) return offset;
  return std::nullopt;
}

}  // namespace sextant
