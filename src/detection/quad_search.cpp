// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "quad_search.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "contour_corners.hpp"

namespace sextant {
namespace {

// Widths of the neighbourhoods whose mean is the threshold, pixels of the half image.
const std::vector<int> kQuickBlocks = {5}, kBlocks = {3, 13};
constexpr double kDarker = 7, kMuchDarker = 10;  // grey levels below the mean around it: dark
constexpr double kStraight = 0.04;   // share of a contour's length that it may stand off its polygon
constexpr double kBlunt = 2;         // pixels, likewise: so much the corners of small ones are cut off
constexpr double kWinding = 1.5;     // a contour's length over its box's outline: more is no quad
constexpr double kEnclosed = 0.015;  // area over squared length: less is a line
constexpr double kNarrow = 1.0 / 8;  // shorter side over longer: what is seen more obliquely is not read
constexpr double kSame = 0.15;       // share of its size by which both contours of one edge differ

// Each side with the one across, since a blunt corner makes one of a small quad's too short.
double shorter(const std::vector<cv::Point>& quad, double* longer) {
  const double a = cv::norm(quad[0] - quad[1]) + cv::norm(quad[2] - quad[3]);
  const double b = cv::norm(quad[1] - quad[2]) + cv::norm(quad[3] - quad[0]);
  *longer = 0.5 * std::max(a, b);
  return 0.5 * std::min(a, b);
}

// Of a pixel's centre in the half image, and with the edge that lies half a pixel beyond.
cv::Rect inFullImage(const cv::Rect& box) {
  return {2 * box.x - 1, 2 * box.y - 1, 2 * box.width + 2, 2 * box.height + 2};
}

// Equal weights, which sum up to 1 in the 256ths in which OpenCV counts them; unlike cv::blur in
// vector code, and unlike cv::GaussianBlur without a kernel to compute, which takes longer than a small part.
void meanAround(const cv::Mat& image, int block, cv::Mat& mean) {
  static const cv::Mat three = (cv::Mat_<float>(1, 3) << 85, 86, 85) / 256;
  static const cv::Mat five = (cv::Mat_<float>(1, 5) << 51, 51, 52, 51, 51) / 256;
  if (block > 5) return cv::blur(image, mean, {block, block}, {-1, -1}, cv::BORDER_REPLICATE);
  const cv::Mat& kernel = block == 3 ? three : five;
  cv::sepFilter2D(image, mean, CV_8U, kernel, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
}

// A convex contour has no more pixels than its box's outline; texture winds more.
bool windsTooMuch(const std::vector<cv::Point>& contour, const cv::Rect& box) {
  return static_cast<double>(contour.size()) > kWinding * 2 * (box.width + box.height);
}

// A quad of sides a, b has the area a b sin, and its contour at most 2 (a + b) pixels.
bool enclosesTooLittle(const std::vector<cv::Point>& contour) {
  const double length = static_cast<double>(contour.size());
  return cv::contourArea(contour) < kEnclosed * length * length;
}

bool sameEdge(const cv::Rect& larger, const cv::Rect& other) {
  const double near = 4 + kSame * std::max(larger.width, larger.height);
  return std::abs(larger.x - other.x) < near && std::abs(larger.y - other.y) < near &&
         std::abs(larger.br().x - other.br().x) < near && std::abs(larger.br().y - other.br().y) < near;
}

// With the border replicated, nothing is darker than its surroundings where the threshold's block leaves the
// image.
bool isCutOff(const cv::Rect& box, const cv::Size& image) {
  constexpr int kNear = 4;
  return box.x < kNear || box.y < kNear || box.br().x > image.width - kNear ||
         box.br().y > image.height - kNear;
}

// Without an odd last row or column: any other factor than two takes ten times as long.
void halve(const cv::Mat& image, cv::Mat& half) {
  const cv::Rect even(0, 0, image.cols / 2 * 2, image.rows / 2 * 2);
  cv::resize(image(even), half, even.size() / 2, 0, 0, cv::INTER_AREA);
}

}  // namespace

const std::vector<QuadCandidate>& QuadSearch::find(const cv::Mat& image, const cv::Rect& part,
                                                   double min_side, Effort effort) {
  found_.clear();
  cut_off_.clear();
  if (part.width < 8 || part.height < 8) return found_;
  halve(image(part), half_);
  for (const int block : effort == Effort::quick ? kQuickBlocks : kBlocks) {
    meanAround(half_, block, mean_);
    cv::subtract(mean_, half_, dark_);  // with the next line as cv::adaptiveThreshold, at a third of its time
    cv::threshold(dark_, dark_, (effort == Effort::quick ? kMuchDarker : kDarker) - 1, 255,
                  cv::THRESH_BINARY);
    collect(part.tl(), min_side / 2);
  }
  std::sort(found_.begin(), found_.end(),
            [](const QuadCandidate& a, const QuadCandidate& b) { return a.box.area() > b.box.area(); });
  return found_;
}

void QuadSearch::collect(const cv::Point& origin, double min_side) {
  cv::findContours(dark_, contours_, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  const double min_points = 2.5 * min_side;  // a contour's diagonal steps count once
  for (const auto& contour : contours_) {
    if (static_cast<double>(contour.size()) < min_points) continue;
    const cv::Rect box = cv::boundingRect(contour);
    if (isCutOff(box, dark_.size()) && std::max(box.width, box.height) >= min_side)
      cut_off_.push_back(inFullImage(box) + origin);
    if (!isQuad(contour, box)) continue;
    double longer;
    const double side = shorter(polygon_, &longer);
    if (side < 0.8 * min_side || side <= kNarrow * longer) continue;
    QuadCandidate quad{inFullImage(cv::boundingRect(polygon_)) + origin, 2 * side,
                       contourCorners(contour, polygon_)};
    for (cv::Point2f& corner : quad.corners)
      corner = 2 * corner + cv::Point2f(0.5F, 0.5F) + cv::Point2f(origin);
    found_.push_back(quad);
  }
}

bool QuadSearch::isQuad(const std::vector<cv::Point>& contour, const cv::Rect& box) {
  if (windsTooMuch(contour, box) || enclosesTooLittle(contour)) return false;
  const double off = std::max(kBlunt, kStraight * static_cast<double>(contour.size()));
  cv::approxPolyDP(contour, polygon_, off, true);
  return polygon_.size() == 4 && cv::isContourConvex(polygon_);
}

const std::vector<QuadCandidate>& QuadSearch::distinct() {
  distinct_.clear();
  for (const QuadCandidate& quad : found_)
    if (std::none_of(distinct_.begin(), distinct_.end(),
                     [&](const QuadCandidate& other) { return sameEdge(other.box, quad.box); }))
      distinct_.push_back(quad);
  return distinct_;
}

}  // namespace sextant
