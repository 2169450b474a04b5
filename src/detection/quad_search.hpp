// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace sextant {

/// A quadrilateral that may be a marker.
struct QuadCandidate {
  cv::Rect box;                        ///< bounding box, pixels
  double side;                         ///< shorter side, pixels
  std::array<cv::Point2f, 4> corners;  ///< clockwise, pixels; intersections of the fitted sides
};

/// How thorough a search is.
enum class Effort { quick, thorough };

/// Finds quadrilaterals (dark on light or light on dark) at half resolution with the method of OpenCV's aruco
/// module: adaptive thresholds, contours, polygons. At half resolution a marker too small to be read still
/// has its outline, and most contours from noise disappear. A thorough search is repeated at a quarter of the
/// resolution, where motion blur is narrow, and for small quads at the full one. Reuses its buffers.
class QuadSearch {
 public:
  /// Searches a part of an image.
  /// @param image 8-bit grey
  /// @param part region that is searched, pixels
  /// @param min_side shortest side of the smallest quad, pixels
  /// @param effort quick: a single threshold, which also finds small quads, but fewer of low contrast
  /// @return the largest of each resolution first; valid until the next call
  const std::vector<QuadCandidate>& find(const cv::Mat& image, const cv::Rect& part, double min_side,
                                         Effort effort);
  /// All quads of the last search.
  const std::vector<QuadCandidate>& all() const { return found_; }
  /// The quads of the last search with only the first of those at both sides of one border.
  const std::vector<QuadCandidate>& distinct();
  /// Boxes of outlines that the border of the searched part cuts off, pixels.
  const std::vector<cv::Rect>& cutOff() const { return cut_off_; }

 private:
  struct Scale {
    cv::Point origin;
    int factor;                 // by which the image is reduced
    double min_side, max_side;  // pixels of the full image
  };
  void findAt(const cv::Mat& reduced, const Scale& scale, Effort effort);
  void collect(const Scale& scale);
  void keep(const std::vector<cv::Point>& contour, const Scale& scale);
  bool isQuad(const std::vector<cv::Point>& contour, const cv::Rect& box);

  cv::Mat half_, quarter_, mean_, dark_;
  std::vector<std::vector<cv::Point>> contours_;
  std::vector<cv::Point> polygon_;
  std::vector<QuadCandidate> found_, distinct_;
  std::vector<cv::Rect> cut_off_;
};

}  // namespace sextant
