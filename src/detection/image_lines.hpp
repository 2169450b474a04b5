// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "edge_curve.hpp"

namespace sextant {

/// Moments of the grey level gradient on an image line across an edge, about a position x0.
struct RiseMoments {
  double contrast = 0;  ///< sum w I', with w = (1 - u^2)^2, u = (x - x0) / reach
  double first = 0;     ///< sum w (x - x0) I'
  double flank = 0;     ///< sum u^2 (1 - u^2) I'

  /// -d/dx0 of first over contrast: 1 for a step far narrower than the reach, 0 for one wider than it.
  double sharpness() const { return 1 - 4 * flank / contrast; }
};

/// The image lines (rows or columns) that are more nearly perpendicular to an edge. Each crosses the edge
/// once, so that no pixel is used twice and the noise of the lines is independent. Both arguments must
/// outlive it.
class ImageLines {
 public:
  ImageLines(const cv::Mat& image, const EdgeCurve& curve);

  /// A range of lines.
  struct Span {
    int first, last, step;
    int count() const { return last < first ? 0 : (last - first) / step + 1; }
  };
  /// At most max_lines lines between the corners, without the blur of these.
  /// @param reach pixels to either side of the edge that are used
  Span span(double reach, int max_lines) const;

  /// Position on a line at which it crosses the curve.
  double crossing(int line) const;
  /// The line nearest to a pixel, and the position on it that is reached from the pixel along the edge.
  int nearest(const Eigen::Vector2d& pixel, double* x) const;
  Eigen::Vector2d pixel(int line, double x) const;  ///< pixel of a position on a line
  /// Distance along the edge's normal per pixel along a line.
  double normal() const { return normal_; }

  /// Moments about x0; nothing if the reach leaves the image.
  std::optional<RiseMoments> moments(int line, double x0, double reach) const;
  /// Position of the steepest rise over two pixels; nothing if it is less than min_rise grey levels.
  std::optional<double> steepest(int line, double x0, double reach, int min_rise) const;

 private:
  const uchar* pixels(int line, int first, int last) const;

  const EdgeCurve& curve_;
  int along_;  // index of the coordinate that counts the lines
  const uchar* data_;
  std::ptrdiff_t line_stride_, stride_;
  int line_count_, size_;
  double normal_;
};

}  // namespace sextant
