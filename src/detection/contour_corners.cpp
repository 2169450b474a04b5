// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "contour_corners.hpp"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr double kEnds = 0.15;     // fraction of a side at either end that is not used for its line
constexpr double kParallel = 0.1;  // sine of the minimum angle between adjacent lines
constexpr double kFarthest =
    0.25;  // maximum distance of a corner from the polygon's, over the side, plus a pixel

struct Line {
  cv::Point2d point, along;  // along has length 1
};

double cross(const cv::Point2d& a, const cv::Point2d& b) { return a.x * b.y - a.y * b.x; }

// Fits a line to the points of the contour between two indices, which wrap around. The principal axis of
// their scatter minimizes the sum of squared distances.
Line fit(const std::vector<cv::Point>& contour, size_t begin, size_t end) {
  const auto skip = static_cast<size_t>(kEnds * static_cast<double>(end - begin));
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (size_t i = begin + skip; i <= end - skip; ++i, ++n) {
    const cv::Point2d p = contour[i % contour.size()];
    x += p.x, y += p.y, xx += p.x * p.x, xy += p.x * p.y, yy += p.y * p.y;
  }
  const double angle = 0.5 * std::atan2(2 * (xy - x * y / n), (xx - x * x / n) - (yy - y * y / n));
  Line line{{x / n, y / n}, {std::cos(angle), std::sin(angle)}};
  const cv::Point2d forward = contour[end % contour.size()] - contour[begin % contour.size()];
  if (line.along.dot(forward) < 0) line.along = -line.along;
  return line;
}

// Moves a line from the outermost dark pixels to the edge. findContours follows dark regions and their holes
// with the edge always on the same side.
Line onEdge(Line line) {
  line.point += 0.5 * cv::Point2d(-line.along.y, line.along.x);
  return line;
}

cv::Point2d meet(const Line& a, const Line& b, const cv::Point2d& fallback, double reach) {
  const double sine = cross(a.along, b.along);
  if (std::abs(sine) < kParallel) return fallback;
  const cv::Point2d corner = a.point + a.along * (cross(b.point - a.point, b.along) / sine);
  return cv::norm(corner - fallback) > reach ? fallback : corner;
}

size_t indexOf(const cv::Point& vertex, const std::vector<cv::Point>& contour) {
  return static_cast<size_t>(std::find(contour.begin(), contour.end(), vertex) - contour.begin());
}

}  // namespace

std::array<cv::Point2f, 4> contourCorners(const std::vector<cv::Point>& contour,
                                          const std::vector<cv::Point>& polygon) {
  std::array<Line, 4> lines;
  for (int i = 0; i < 4; ++i) {
    const size_t begin = indexOf(polygon[i], contour);
    size_t end = indexOf(polygon[(i + 1) % 4], contour);
    if (end <= begin) end += contour.size();
    lines[i] = onEdge(fit(contour, begin, end));
  }
  std::array<cv::Point2f, 4> corners;
  for (int i = 0; i < 4; ++i) {
    const double sides =
        cv::norm(polygon[i] - polygon[(i + 3) % 4]) + cv::norm(polygon[i] - polygon[(i + 1) % 4]);
    corners[i] = meet(lines[(i + 3) % 4], lines[i], polygon[i], 1 + 0.5 * kFarthest * sides);
  }
  if (cross(corners[1] - corners[0], corners[2] - corners[1]) < 0) std::swap(corners[1], corners[3]);
  return corners;
}

}  // namespace sextant
