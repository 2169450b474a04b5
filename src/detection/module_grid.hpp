// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "edge_curve.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// The modules of a marker as one of its sides sees them: u runs along this side from 0 to 1, v inward.
class ModuleGrid {
 public:
  /// @param corners pixels; the side begins at corners[side]
  /// @param near the side's edge
  /// @param far the edge across
  ModuleGrid(const Corners& corners, int side, int modules, const EdgeCurve& near, const EdgeCurve& far);

  /// Pixel of (u, v): the square's homography, and between both edges what the lens bends of them.
  Eigen::Vector2d at(double u, double v) const;

  /// How far the bits stand outward of where they should be as seen from this side: the median over their
  /// steps on the first line of the grid that shows one of them. An edge that is not the marker's own, but
  /// that of something laid over it by x pixels, shows (1 - v) x, the edge across only v x.
  /// @param contrast of the side's edge, grey levels
  /// @return pixels along the near edge's normal, or nothing where there are too few steps
  std::optional<double> bitOffset(const cv::Mat& image, double contrast) const;

 private:
  std::optional<double> lineOffset(const cv::Mat& image, int line, double contrast) const;
  Eigen::Vector2d flat(double u, double v) const;

  const EdgeCurve &near_, &far_;
  int modules_;
  Eigen::Matrix3d H_;
};

}  // namespace sextant
