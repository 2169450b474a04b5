// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "edge_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "image_lines.hpp"

namespace sextant {
namespace {

constexpr int kMaxSamples = 100;
constexpr int kMinContrast = 12;       // of a sample, grey levels
constexpr double kMinShare = 0.4;      // minimum contrast of a sample over the edge's median contrast
constexpr double kOutlier = 3 * 1.48;  // limit of residuals, median absolute deviations
constexpr double kMinSharpness = 0.2;  // limits the Newton step

struct Sample {
  int line;  // index of the image line
  double x;  // initial position on the image line, pixels
  RiseMoments moments;
  double s = 0, offset = 0;  // of the located edge; the offset is from the initial curve
};

// A list of samples without heap allocation.
class Samples {
 public:
  int size() const { return size_; }
  Sample* begin() { return samples_.data(); }
  Sample* end() { return begin() + size_; }
  const Sample* begin() const { return samples_.data(); }
  const Sample* end() const { return begin() + size_; }
  void add(const Sample& sample) { samples_[size_++] = sample; }

  template <typename Drop>
  void removeIf(Drop drop) {
    size_ = static_cast<int>(std::remove_if(begin(), end(), drop) - begin());
  }

  // Median of a value. If there are many samples, uses every second or third of them, which suffices for
  // outlier limits.
  template <typename Value>
  double median(Value value) const {
    std::array<double, kMaxSamples> values;
    const int step = std::max(1, size_ / 30);
    int count = 0;
    for (int i = 0; i < size_; i += step) values[count++] = value(samples_[i]);
    std::nth_element(values.begin(), values.begin() + count / 2, values.begin() + count);
    return values[count / 2];
  }

 private:
  std::array<Sample, kMaxSamples> samples_;
  int size_ = 0;
};

Samples collect(const ImageLines& lines, const ImageLines::Span& span, double reach) {
  Samples samples;
  for (int line = span.first; line <= span.last; line += span.step) {
    const double x = lines.crossing(line);
    const auto sums = lines.moments(line, x, reach);
    if (sums && sums->contrast >= kMinContrast) samples.add({line, x, *sums});
  }
  if (samples.size() == 0) return samples;
  const double least =
      kMinShare * samples.median([](const Sample& sample) { return sample.moments.contrast; });
  samples.removeIf([&](const Sample& sample) { return sample.moments.contrast < least; });
  return samples;
}

// Takes a Newton step for every sample, with the derivative summed over the whole edge, because that of one
// image line is too noisy.
void locate(const ImageLines& lines, Samples& samples, EdgeFit& fit) {
  RiseMoments sum;
  for (const Sample& sample : samples) {
    sum.contrast += sample.moments.contrast;
    sum.flank += sample.moments.flank;
  }
  fit.contrast = sum.contrast / samples.size();
  fit.sharpness = std::max(kMinSharpness, sum.sharpness());
  for (Sample& sample : samples) {
    const double step = sample.moments.first / (sample.moments.contrast * fit.sharpness);
    const Eigen::Vector2d p = lines.pixel(sample.line, sample.x + step) - fit.curve.middle;
    sample.s = p.dot(fit.curve.half) / fit.curve.half.squaredNorm();
    sample.offset = p.dot(fit.curve.normal) - fit.curve.offset(sample.s);
  }
}

// Returns the least squares fit of c[0] + c[1] s (+ c[2] s^2), and the inverse of its normal equations.
Eigen::Vector3d solve(const Samples& samples, int terms, Eigen::Matrix3d& inverse) {
  double s1 = 0, s2 = 0, s3 = 0, s4 = 0;
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples) {
    const double s = sample.s, square = s * s;
    s1 += s, s2 += square, s3 += s * square, s4 += square * square;
    b[0] += sample.offset, b[1] += sample.offset * s, b[2] += sample.offset * square;
  }
  Eigen::Matrix3d A;
  A << samples.size(), s1, s2, s1, s2, s3, s2, s3, s4;
  inverse.setZero();
  if (terms == 3)
    inverse = A.inverse();
  else
    inverse.topLeftCorner<2, 2>() = A.topLeftCorner<2, 2>().inverse();
  return inverse * b;
}

double residual(const Sample& sample, const Eigen::Vector3d& c) {
  return sample.offset - (c[0] + sample.s * (c[1] + sample.s * c[2]));
}

void dropOutliers(Samples& samples, const Eigen::Vector3d& c, double min_limit) {
  const double spread = samples.median([&](const Sample& sample) { return std::abs(residual(sample, c)); });
  const double limit = std::max(kOutlier * spread, min_limit);
  samples.removeIf([&](const Sample& sample) { return std::abs(residual(sample, c)) > limit; });
}

void measureScatter(const Samples& samples, const Eigen::Vector3d& c, int terms, EdgeFit& fit) {
  double last = 0;
  for (const Sample& sample : samples) {
    const double r = residual(sample, c);
    fit.squared_residuals += r * r;
    fit.lagged_products += r * last;
    last = r;
  }
  fit.degrees_of_freedom = samples.size() - terms;
}

// Returns the line through two samples with the smallest truncated sum of squared residuals.
std::optional<Eigen::Vector3d> consensusLine(const Samples& samples, double limit) {
  double best = limit * limit * samples.size();
  std::optional<Eigen::Vector3d> line;
  for (const Sample& a : samples)
    for (const Sample* b = &a + 1; b < samples.end(); ++b) {
      if (std::abs(a.s - b->s) < 0.5) continue;
      const double slope = (b->offset - a.offset) / (b->s - a.s);
      const Eigen::Vector3d c(a.offset - slope * a.s, slope, 0);
      double cost = 0;
      for (const Sample& sample : samples) {
        const double r = residual(sample, c);
        cost += std::min(r * r, limit * limit);
      }
      if (cost >= best) continue;
      best = cost;
      line = c;
    }
  return line;
}

// For a step with the profile exp(-x^2 / 2 blur^2) and w close to exp(-2 u^2): sharpness = 1 / (1 + 4 blur^2
// / reach^2).
double blurOf(double sharpness, double reach) {
  return 0.5 * reach * std::sqrt(std::max(0.0, 1 / sharpness - 1));
}

void move(EdgeCurve& curve, const Eigen::Vector3d& by) {
  for (int k = 0; k < 3; ++k) curve.c[k] += by[k];
}

}  // namespace

double EdgeFit::leverage(double s) const {
  const Eigen::Vector3d row(1, s, s * s);
  return row.dot(normal_inverse * row);
}

std::optional<EdgeCurve> searchEdge(const cv::Mat& image, const EdgeCurve& start, const EdgeSearch& search) {
  const ImageLines lines(image, start);
  const ImageLines::Span span = lines.span(search.reach, search.max_samples);
  EdgeFit fit(start);
  Samples samples;
  for (int line = span.first; line <= span.last; line += span.step)
    if (const auto x = lines.steepest(line, lines.crossing(line), search.reach, kMinContrast))
      samples.add({line, *x, {1}});
  if (samples.size() == 0) return std::nullopt;
  locate(lines, samples, fit);
  const double limit = 0.75 + 0.01 * start.length();  // about a pixel, plus lens distortion
  const auto line = consensusLine(samples, limit);
  if (!line) return std::nullopt;
  samples.removeIf([&](const Sample& sample) { return std::abs(residual(sample, *line)) > limit; });
  if (2 * samples.size() < span.count()) return std::nullopt;
  move(fit.curve, solve(samples, 2, fit.normal_inverse));
  return fit.curve;
}

std::optional<EdgeFit> fitEdge(const cv::Mat& image, const EdgeCurve& start, const EdgeSearch& search) {
  const ImageLines lines(image, start);
  const ImageLines::Span span = lines.span(search.reach, search.max_samples);
  Samples samples = collect(lines, span, search.reach);
  const int least = std::max(search.terms + 3, (span.count() + 1) / 2);
  if (samples.size() < least) return std::nullopt;
  EdgeFit fit(start);
  locate(lines, samples, fit);
  const double shift = samples.median([](const Sample& sample) { return sample.offset; });
  dropOutliers(samples, {shift, 0, 0}, 0.5);
  if (samples.size() < least) return std::nullopt;
  dropOutliers(samples, solve(samples, search.terms, fit.normal_inverse), 0.05);
  if (samples.size() < least) return std::nullopt;
  const Eigen::Vector3d c = solve(samples, search.terms, fit.normal_inverse);
  measureScatter(samples, c, search.terms, fit);
  fit.blur = blurOf(fit.sharpness, search.reach);
  move(fit.curve, c);
  return fit;
}

std::optional<double> stepOffset(const cv::Mat& image, const EdgeCurve& along, const Eigen::Vector2d& point,
                                 double reach, double min_contrast) {
  const ImageLines lines(image, along);
  double x;
  const int line = lines.nearest(point, &x);
  const auto sums = lines.moments(line, x, reach);
  if (!sums || std::abs(sums->contrast) < min_contrast) return std::nullopt;
  const double sharpness = std::max(kMinSharpness, sums->sharpness());
  const double offset = sums->first / (sums->contrast * sharpness) * lines.normal();
  return std::abs(offset) < reach ? std::optional<double>(offset) : std::nullopt;
}

}  // namespace sextant
