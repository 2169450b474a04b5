// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_search.hpp"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr double kMinMargin = 6;  // pixels around a quad, which must not touch the border of the window
constexpr double kQuiet = 0.1;    // the same as a fraction of its size

// Whether two detections are of the same marker, not of two markers with one id.
bool same(const MarkerKey& key, const Corners& corners, const Detection& other) {
  const double larger = std::max(perimeter(corners), perimeter(other.corners));
  return other.key == key && (centre(corners) - centre(other.corners)).norm() < larger / 8;
}

double crossProduct(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool inside(const Corners& corners, const Eigen::Vector2d& pixel) {
  int left = 0;
  for (int i = 0; i < 4; ++i) left += crossProduct(corners[(i + 1) % 4] - corners[i], pixel - corners[i]) > 0;
  return left == 0 || left == 4;
}

}  // namespace

cv::Rect widened(const cv::Rect& box, double margin, const cv::Size& image) {
  const int pixels = static_cast<int>(std::ceil(margin));
  const cv::Rect wide(box.x - pixels, box.y - pixels, box.width + 2 * pixels, box.height + 2 * pixels);
  return wide & cv::Rect({0, 0}, image);
}

bool touchesBorder(const cv::Rect& window, const cv::Size& image) {
  return window.x == 0 || window.y == 0 || window.br().x == image.width || window.br().y == image.height;
}

cv::Rect windowOf(const QuadCandidate& quad, const cv::Size& image) {
  return widened(quad.box, kMinMargin + kQuiet * std::max(quad.box.width, quad.box.height), image);
}

void MarkerSearch::inside(const cv::Mat& image, QuadSearch& quads, Effort effort, FoundMarkers& found) {
  for (const QuadCandidate& quad : quads.distinct())
    if (!found.cover(quad)) within(image, windowOf(quad, image.size()), quad.side, effort, found);
}

void FoundMarkers::add(const Detection& detection) {
  const auto twin = std::find_if(markers.begin(), markers.end(), [&](const Detection& other) {
    return same(detection.key, detection.corners, other);
  });
  if (twin == markers.end())
    markers.push_back(detection);
  else if (twin - markers.begin() >= static_cast<long>(refined) &&
           perimeter(detection.corners) > perimeter(twin->corners))
    *twin = detection;
}

bool FoundMarkers::cover(const QuadCandidate& quad) const {
  const Eigen::Vector2d middle =
      0.5 * Eigen::Vector2d(2 * quad.box.x + quad.box.width, 2 * quad.box.y + quad.box.height);
  return std::any_of(markers.begin(), markers.end(),
                     [&](const Detection& found) { return inside(found.corners, middle); });
}

bool FoundMarkers::include(const MarkerKey& key, const Corners& near) const {
  return std::any_of(markers.begin(), markers.end(), [&](const Detection& found) {
    const double reach = perimeter(near) / 8;
    return found.key == key && (centre(found.corners) - centre(near)).norm() < reach;
  });
}

}  // namespace sextant
