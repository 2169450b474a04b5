// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "edge_curve.hpp"

namespace sextant {

/// The rise of the grey levels along an edge's normal, about a place x0 on an image line.
struct RiseMoments {
  double contrast = 0;  ///< sum w I', with w = (1 - u^2)^2, u = (x - x0) / reach
  double first = 0;     ///< sum w (x - x0) I'
  double flank = 0;     ///< sum u^2 (1 - u^2) I'

  /// -d/dx0 of first over contrast: 1 where the step is far narrower than the reach, 0 where it does not end
  /// within.
  double sharpness() const { return 1 - 4 * flank / contrast; }
};

/// The image lines (rows, or columns) that an edge crosses most nearly at right angles. Each meets the edge
/// once, so that no pixel is read twice and every line has noise of its own. Both arguments must outlive it.
class ImageLines {
 public:
  ImageLines(const cv::Mat& image, const EdgeCurve& curve);

  struct Span {
    int first, last, step;
    int count() const { return last < first ? 0 : (last - first) / step + 1; }
  };
  /// At most so many lines between the blurs of both corners.
  /// @param reach pixels to either side of the edge that are looked at
  Span span(double reach, int max_lines) const;

  /// Where a line meets the curve.
  double crossing(int line) const;
  /// The line that passes nearest to a pixel, and where on it one comes from there along the edge.
  int nearest(const Eigen::Vector2d& pixel, double* x) const;
  Eigen::Vector2d pixel(int line, double x) const;
  /// Pixels along the edge's normal for one along a line.
  double normal() const { return normal_; }

  /// Nothing where the reach leaves the image.
  std::optional<RiseMoments> moments(int line, double x0, double reach) const;
  /// Where the grey levels rise most over two pixels; nothing where they rise by less than min_rise.
  std::optional<double> steepest(int line, double x0, double reach, int min_rise) const;

 private:
  const uchar* pixels(int line, int first, int last) const;

  const EdgeCurve& curve_;
  int along_;  // coordinate that numbers the lines
  const uchar* data_;
  std::ptrdiff_t line_stride_, stride_;
  int line_count_, size_;
  double normal_;
};

}  // namespace sextant
