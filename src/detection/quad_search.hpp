// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace sextant {

/// A place in an image that is worth a detector's time.
struct QuadCandidate {
  cv::Rect box;                        ///< of the quad, pixels
  double side;                         ///< its shorter side, pixels
  std::array<cv::Point2f, 4> corners;  ///< clockwise, pixels; where the lines of its sides meet
};

enum class Effort { quick, thorough };

/// Finds quadrilaterals (dark on light or light on dark) in an image of half the width and height, as
/// OpenCV's aruco module does in the whole one: adaptive thresholds, contours, polygons. A print too small to
/// be read there still has its outline; most contours that noise makes in the whole image are gone. Keeps its
/// memory from image to image.
class QuadSearch {
 public:
  /// @param image 8-bit grey
  /// @param part of it that is searched
  /// @param min_side pixels; shortest side of the smallest quad
  /// @param effort quick: one threshold, with which small quads are found as well, but fewer of low contrast
  /// @return the largest first; valid until the next call
  const std::vector<QuadCandidate>& find(const cv::Mat& image, const cv::Rect& part, double min_side,
                                         Effort effort);
  /// Those found.
  const std::vector<QuadCandidate>& all() const { return found_; }
  /// One of those found for both sides of one edge: the larger.
  const std::vector<QuadCandidate>& distinct();
  /// Outlines that the border of the searched part cuts off: their boxes, pixels.
  const std::vector<cv::Rect>& cutOff() const { return cut_off_; }

 private:
  void collect(const cv::Point& origin, double min_side);
  bool isQuad(const std::vector<cv::Point>& contour, const cv::Rect& box);

  cv::Mat half_, mean_, dark_;
  std::vector<std::vector<cv::Point>> contours_;
  std::vector<cv::Point> polygon_;
  std::vector<QuadCandidate> found_, distinct_;
  std::vector<cv::Rect> cut_off_;
};

}  // namespace sextant
