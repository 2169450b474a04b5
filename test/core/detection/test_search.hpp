// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>

#include "marker_search.hpp"
#include "sextant/markers/marker_family.hpp"

namespace sextant {

constexpr int kSearchModule = 10;  // pixels
const cv::Point kSearchOrigin(120, 80);

/// A marker's modules, head-on, ten pixels each, in a white image.
inline cv::Mat searchImage(const cv::Mat& modules) {
  cv::Mat image(320, 400, CV_8U, cv::Scalar(255)), print;
  cv::resize(modules, print, {}, kSearchModule, kSearchModule, cv::INTER_NEAREST);
  print.copyTo(image(cv::Rect(kSearchOrigin, print.size())));
  cv::GaussianBlur(image, image, {}, 0.8);
  return image;
}

/// Where its corners are there: half a pixel outside of the outermost pixels' centres.
inline Corners searchCorners(const MarkerImage& marker) {
  const double x = kSearchOrigin.x - 0.5, y = kSearchOrigin.y - 0.5;
  const double a = kSearchModule * marker.border_begin, b = kSearchModule * marker.border_end;
  return {Eigen::Vector2d(x + a, y + a), {x + b, y + a}, {x + b, y + b}, {x + a, y + b}};
}

inline double farthestCorner(const Corners& a, const Corners& b) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

}  // namespace sextant
