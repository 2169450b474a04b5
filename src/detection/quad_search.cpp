// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "quad_search.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "contour_corners.hpp"

namespace sextant {
namespace {

// Window widths of the adaptive thresholds, pixels at half resolution.
const std::vector<int> kQuickBlocks = {5}, kBlocks = {3, 13};
constexpr double kDarker = 7, kMuchDarker = 10;  // grey levels below the local mean of a dark pixel
constexpr double kStraight = 0.04;   // maximum distance of a contour from its polygon, over its length
constexpr double kBlunt = 2;         // minimum of this distance, pixels: corners of small quads are rounded
constexpr double kWinding = 1.5;     // maximum length of a quad's contour over its box's outline
constexpr double kEnclosed = 0.015;  // minimum area over squared length; less is a line
constexpr double kNarrow = 1.0 / 8;  // minimum ratio of the sides; more oblique markers cannot be read
constexpr double kSame = 0.15;       // maximum difference of both contours of one border, over its size

// Averages opposite sides, because a rounded corner shortens one side of a small quad.
double shorter(const std::vector<cv::Point>& quad, double* longer) {
  const double a = cv::norm(quad[0] - quad[1]) + cv::norm(quad[2] - quad[3]);
  const double b = cv::norm(quad[1] - quad[2]) + cv::norm(quad[3] - quad[0]);
  *longer = 0.5 * std::max(a, b);
  return 0.5 * std::min(a, b);
}

// From half to full resolution, including the edge half a pixel outside the outermost pixel centres.
cv::Rect inFullImage(const cv::Rect& box) {
  return {2 * box.x - 1, 2 * box.y - 1, 2 * box.width + 2, 2 * box.height + 2};
}

// Box filter with weights that sum to 1 in OpenCV's 8-bit fixed point. Vectorized, unlike cv::blur; without
// computing a kernel, which in cv::GaussianBlur takes longer than filtering a small part.
void meanAround(const cv::Mat& image, int block, cv::Mat& mean) {
  static const cv::Mat three = (cv::Mat_<float>(1, 3) << 85, 86, 85) / 256;
  static const cv::Mat five = (cv::Mat_<float>(1, 5) << 51, 51, 52, 51, 51) / 256;
  if (block > 5) return cv::blur(image, mean, {block, block}, {-1, -1}, cv::BORDER_REPLICATE);
  const cv::Mat& kernel = block == 3 ? three : five;
  cv::sepFilter2D(image, mean, CV_8U, kernel, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
}

// A convex contour has at most as many pixels as its box's outline; contours of texture have more.
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

// The replicated border hides dark regions near the image border.
bool isCutOff(const cv::Rect& box, const cv::Size& image) {
  constexpr int kNear = 4;
  return box.x < kNear || box.y < kNear || box.br().x > image.width - kNear ||
         box.br().y > image.height - kNear;
}

// Drops an odd last row or column, because any other factor than exactly two takes ten times as long.
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
    cv::subtract(mean_, half_, dark_);  // with the next line: cv::adaptiveThreshold in a third of the time
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
  const double min_points = 2.5 * min_side;  // less than four sides, because diagonal steps count once
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
