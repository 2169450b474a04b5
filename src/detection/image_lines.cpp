// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "image_lines.hpp"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr double kCornerBlur = 1.5;  // pixels from a corner within which the adjacent edge has an effect

}  // namespace

ImageLines::ImageLines(const cv::Mat& image, const EdgeCurve& curve)
    : curve_(curve),
      along_(std::abs(curve.half.y()) >= std::abs(curve.half.x()) ? 1 : 0),
      data_(image.data),
      normal_(curve.normal[1 - along_]) {
  const std::ptrdiff_t strides[] = {1, static_cast<std::ptrdiff_t>(image.step)};
  const int sizes[] = {image.cols, image.rows};
  line_stride_ = strides[along_];
  stride_ = strides[1 - along_];
  line_count_ = sizes[along_];
  size_ = sizes[1 - along_];
}

// Inside the square, a line that is not perpendicular to the edge approaches one of the adjacent edges.
ImageLines::Span ImageLines::span(double reach, int max_lines) const {
  const double length = curve_.length(), blur = std::min(kCornerBlur, 0.15 * length);
  const double drift = -0.5 * reach * curve_.half[1 - along_] / (0.5 * length * normal_);
  const double begin = -1 + 2 * (blur + std::max(0.0, -drift)) / length;
  const double end = 1 - 2 * (blur + std::max(0.0, drift)) / length;
  const double a = curve_.middle[along_] + begin * curve_.half[along_];
  const double b = curve_.middle[along_] + end * curve_.half[along_];
  Span span{static_cast<int>(std::ceil(std::min(a, b))), static_cast<int>(std::floor(std::max(a, b))), 1};
  span.step = std::max(1, (span.last - span.first + max_lines) / max_lines);
  return span;
}

// Two fixed-point iterations suffice, because the curve is nearly its chord.
double ImageLines::crossing(int line) const {
  double s = 0, offset = 0;
  for (int i = 0; i < 2; ++i) {
    s = (line - curve_.middle[along_] - offset * curve_.normal[along_]) / curve_.half[along_];
    offset = curve_.offset(s);
  }
  return curve_.middle[1 - along_] + s * curve_.half[1 - along_] + offset * normal_;
}

int ImageLines::nearest(const Eigen::Vector2d& pixel, double* x) const {
  const double line = std::round(pixel[along_]);
  *x = pixel[1 - along_] + (line - pixel[along_]) / curve_.half[along_] * curve_.half[1 - along_];
  return static_cast<int>(line);
}

Eigen::Vector2d ImageLines::pixel(int line, double x) const {
  return along_ == 1 ? Eigen::Vector2d(x, line) : Eigen::Vector2d(line, x);
}

const uchar* ImageLines::pixels(int line, int first, int last) const {
  if (line < 0 || line >= line_count_ || first < 0 || last >= size_) return nullptr;
  return data_ + line * line_stride_ + first * stride_;
}

std::optional<RiseMoments> ImageLines::moments(int line, double x0, double reach) const {
  const double half_width = reach / std::abs(normal_), scale = 1 / half_width;
  const int low = static_cast<int>(std::ceil(x0 - half_width - 0.5));
  const int high = static_cast<int>(std::floor(x0 + half_width - 0.5));
  const uchar* pixel = pixels(line, low, high + 1);
  if (!pixel) return std::nullopt;
  double contrast = 0, first = 0, flank = 0, x = low + 0.5 - x0;
  for (int i = low; i <= high; ++i, x += 1, pixel += stride_) {
    const double rise = pixel[stride_] - pixel[0];
    const double u = x * scale, b = 1 - u * u, w = b * b * rise;
    contrast += w;
    first += w * x;
    flank += u * u * b * rise;
  }
  const double sign = normal_ < 0 ? -1 : 1;
  return RiseMoments{sign * contrast, sign * first, sign * flank};
}

std::optional<double> ImageLines::steepest(int line, double x0, double reach, int min_rise) const {
  const double half_width = reach / std::abs(normal_);
  const int low = std::max(1, static_cast<int>(std::ceil(x0 - half_width)));
  const int high = std::min(size_ - 2, static_cast<int>(std::floor(x0 + half_width)));
  const uchar* pixel = pixels(line, low - 1, high + 1);
  if (!pixel || high < low) return std::nullopt;
  const int sign = normal_ < 0 ? -1 : 1;
  int most = min_rise - 1, at = low - 1;
  for (int i = low; i <= high; ++i, pixel += stride_) {
    const int rise = sign * (pixel[2 * stride_] - pixel[0]);
    if (rise <= most) continue;
    most = rise;
    at = i;
  }
  return at < low ? std::nullopt : std::optional<double>(at);
}

}  // namespace sextant
