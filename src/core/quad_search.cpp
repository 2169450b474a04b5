// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "quad_search.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

// Widths of the neighbourhoods whose mean is the threshold, pixels of the half image.
const std::vector<int> kQuickBlocks = {5}, kBlocks = {3, 13};
constexpr double kDarker = 7, kMuchDarker = 10;  // grey levels below the mean around it: dark
constexpr double kStraight = 0.04;   // share of a contour's length that it may stand off its polygon
constexpr double kNarrow = 1.0 / 8;  // shortest side over longest: what is seen more obliquely is not read
constexpr double kSame = 0.15;       // share of its size by which both contours of one edge differ

double shortest(const std::vector<cv::Point>& quad, double* longest) {
  double least = 1e9, most = 0;
  for (size_t i = 0; i < quad.size(); ++i) {
    const double side = cv::norm(quad[i] - quad[(i + 1) % quad.size()]);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  *longest = most;
  return least;
}

// Of a pixel's centre in the half image, and with the edge that lies half a pixel beyond.
cv::Rect inFullImage(const cv::Rect& box) {
  return {2 * box.x - 1, 2 * box.y - 1, 2 * box.width + 2, 2 * box.height + 2};
}

bool sameEdge(const cv::Rect& larger, const cv::Rect& other) {
  const double near = 4 + kSame * std::max(larger.width, larger.height);
  return std::abs(larger.x - other.x) < near && std::abs(larger.y - other.y) < near &&
         std::abs(larger.br().x - other.br().x) < near && std::abs(larger.br().y - other.br().y) < near;
}

}  // namespace

const std::vector<QuadCandidate>& QuadSearch::find(const cv::Mat& image, const cv::Rect& part,
                                                   double min_side, Effort effort) {
  found_.clear();
  kept_.clear();
  if (part.width < 8 || part.height < 8) return kept_;
  cv::resize(image(part), half_, {part.width / 2, part.height / 2}, 0, 0, cv::INTER_AREA);
  for (const int block : effort == Effort::quick ? kQuickBlocks : kBlocks) {
    cv::adaptiveThreshold(half_, dark_, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, block,
                          effort == Effort::quick ? kMuchDarker : kDarker);
    collect(part.tl(), min_side / 2);
  }
  dropDoubles();
  return kept_;
}

void QuadSearch::collect(const cv::Point& origin, double min_side) {
  cv::findContours(dark_, contours_, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  const double min_points = 2.5 * min_side;  // a contour's diagonal steps count once
  for (const auto& contour : contours_) {
    if (static_cast<double>(contour.size()) < min_points) continue;
    cv::approxPolyDP(contour, polygon_, kStraight * static_cast<double>(contour.size()), true);
    if (polygon_.size() != 4 || !cv::isContourConvex(polygon_)) continue;
    double longest;
    const double side = shortest(polygon_, &longest);
    if (side >= 0.8 * min_side && side > kNarrow * longest)
      found_.push_back({inFullImage(cv::boundingRect(polygon_)) + origin, 2 * side});
  }
}

void QuadSearch::dropDoubles() {
  std::sort(found_.begin(), found_.end(),
            [](const QuadCandidate& a, const QuadCandidate& b) { return a.box.area() > b.box.area(); });
  for (const QuadCandidate& quad : found_)
    if (std::none_of(kept_.begin(), kept_.end(),
                     [&](const QuadCandidate& other) { return sameEdge(other.box, quad.box); }))
      kept_.push_back(quad);
}

}  // namespace sextant
