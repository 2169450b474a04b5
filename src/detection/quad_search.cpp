// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "quad_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "contour_corners.hpp"

namespace sextant {
namespace {

// Window widths of the adaptive thresholds, pixels at half resolution.
const std::vector<int> kQuickBlocks = {5}, kBlocks = {3, 13};
// Grey levels below the local mean of a dark pixel: so many standard deviations of the noise between these
// limits.
struct Darkness {
  double deviations, least, most;
};
constexpr Darkness kDarker = {3.5, 2, 7}, kMuchDarker = {5, 2, 10};
constexpr double kRelatively = 0.05;  // least for a quick search, over the mean of the searched part
constexpr double kSmallSide = 24;     // pixels; quads up to this side are also searched at full resolution
constexpr double kAnySide = std::numeric_limits<double>::infinity();
constexpr double kDiagonal = 1.5;    // maximum extent of a quad over its side
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

// From reduced to full resolution, including the edge half a pixel outside the outermost pixel centres.
cv::Rect inFullImage(const cv::Rect& box, int factor) {
  const int edge = factor / 2;
  return {factor * box.x - edge, factor * box.y - edge, factor * box.width + 2 * edge,
          factor * box.height + 2 * edge};
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

// Standard deviation of the noise, grey levels: from the median magnitude of second differences along every
// eighth row, whose variance is six times that of the noise. Median of a Gaussian's magnitude: 0.6745.
double noiseOf(const cv::Mat& image) {
  std::array<int, 1024> histogram{};
  int count = 0;
  for (int y = 0; y < image.rows; y += 8) {
    const uchar* row = image.ptr(y);
    for (int x = 1; x + 1 < image.cols; ++x, ++count)
      ++histogram[std::abs(row[x - 1] - 2 * row[x] + row[x + 1])];
  }
  int bin = 0, below = 0;
  while (2 * (below + histogram[bin]) < count) below += histogram[bin++];
  const double share = (0.5 * count - below) / std::max(1, histogram[bin]);
  const double median = bin == 0 ? 0.5 * share : bin - 0.5 + share;
  return median / (0.6745 * std::sqrt(6.0));
}

double darkness(const cv::Mat& image, Effort effort) {
  const Darkness& limit = effort == Effort::quick ? kMuchDarker : kDarker;
  const double relative = effort == Effort::quick ? kRelatively * cv::mean(image)[0] : 0;
  return std::round(
      std::clamp(std::max(limit.deviations * noiseOf(image), relative), limit.least, limit.most));
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
  const cv::Mat whole = image(part);
  halve(whole, half_);
  findAt(half_, {part.tl(), 2, min_side, kAnySide}, effort);
  if (effort == Effort::quick || std::min(half_.cols, half_.rows) < 8) return found_;
  halve(half_, quarter_);
  findAt(quarter_, {part.tl(), 4, min_side, kAnySide}, Effort::thorough);
  if (min_side < kSmallSide) findAt(whole, {part.tl(), 1, min_side, kSmallSide}, Effort::quick);
  return found_;
}

// The quads of an image follow those of the images before.
void QuadSearch::findAt(const cv::Mat& reduced, const Scale& scale, Effort effort) {
  const double level = darkness(reduced, effort);
  const auto first = static_cast<std::ptrdiff_t>(found_.size());
  for (const int block : effort == Effort::quick ? kQuickBlocks : kBlocks) {
    meanAround(reduced, block, mean_);
    cv::subtract(mean_, reduced, dark_);  // with the next line: cv::adaptiveThreshold in a third of the time
    cv::threshold(dark_, dark_, level - 1, 255, cv::THRESH_BINARY);
    collect(scale);
  }
  std::sort(found_.begin() + first, found_.end(),
            [](const QuadCandidate& a, const QuadCandidate& b) { return a.box.area() > b.box.area(); });
}

void QuadSearch::collect(const Scale& scale) {
  cv::findContours(dark_, contours_, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  const double min_side = scale.min_side / scale.factor;
  const double min_points = 2.5 * min_side;  // less than four sides, because diagonal steps count once
  for (const auto& contour : contours_) {
    if (static_cast<double>(contour.size()) < min_points) continue;
    const cv::Rect box = cv::boundingRect(contour);
    const int extent = std::max(box.width, box.height);
    if (extent * scale.factor > kDiagonal * scale.max_side) continue;
    if (isCutOff(box, dark_.size()) && extent >= min_side)
      cut_off_.push_back(inFullImage(box, scale.factor) + scale.origin);
    if (isQuad(contour, box)) keep(contour, scale);
  }
}

// Keeps the polygon of a contour if it is large and wide enough.
void QuadSearch::keep(const std::vector<cv::Point>& contour, const Scale& scale) {
  double longer;
  const double side = shorter(polygon_, &longer);
  if (side < 0.8 * scale.min_side / scale.factor || side <= kNarrow * longer) return;
  QuadCandidate quad{inFullImage(cv::boundingRect(polygon_), scale.factor) + scale.origin,
                     scale.factor * side, contourCorners(contour, polygon_)};
  const float shift = 0.5F * static_cast<float>(scale.factor - 1);
  for (cv::Point2f& corner : quad.corners)
    corner = scale.factor * corner + cv::Point2f(shift, shift) + cv::Point2f(scale.origin);
  found_.push_back(quad);
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
