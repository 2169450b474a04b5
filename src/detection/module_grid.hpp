// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "edge_curve.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// The module grid of a marker relative to one of its sides: u from 0 to 1 along this side, v inward.
class ModuleGrid {
 public:
  /// @param corners pixels; the side begins at corners[side]
  /// @param near edge of the side
  /// @param far opposite edge
  ModuleGrid(const Corners& corners, int side, int modules, const EdgeCurve& near, const EdgeCurve& far);

  /// Pixel of (u, v): the square's homography plus the interpolated lens distortion of both edges.
  Eigen::Vector2d at(double u, double v) const;

  /// Outward offset of the bits from their expected positions: the median over their steps on the first line
  /// of the grid with any. If something covers the marker by x pixels at this side, the offset is (1 - v) x;
  /// at the opposite side it is only v x.
  /// @param contrast of the side's edge, grey levels
  /// @return pixels along the near edge's normal; nothing if there are too few steps
  std::optional<double> bitOffset(const cv::Mat& image, double contrast) const;

 private:
  std::optional<double> lineOffset(const cv::Mat& image, int line, double contrast) const;
  Eigen::Vector2d flat(double u, double v) const;

  const EdgeCurve &near_, &far_;
  int modules_;
  Eigen::Matrix3d H_;
};

}  // namespace sextant
