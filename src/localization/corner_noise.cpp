// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/corner_noise.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

namespace sextant {
namespace {

constexpr size_t kMinImages = 25;               // number of images before the first estimate
constexpr size_t kMaxImages = 200;              // number of images from which the noise is estimated
constexpr double kMaxExcess = 2.5;              // variance from joint poses over that from single markers
constexpr double kMinDegrees = 6.0;             // of freedom from which the noise of one image is estimated
constexpr double kTailProbability = 1.0 / 400;  // of positions outside the region that is matched
constexpr double kGaussianDegrees = 1e6;        // degrees of freedom above which Student's t is Gaussian
constexpr double kMinScale = 0.05, kMaxScale = 10.0;  // range of factors on corner_sigma

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Median (Wilson and Hilferty 1931) and variance (approximation of the trigamma function psi'(n / 2)) of
// log(x / n), where x is a chi-square variable with n degrees of freedom.
double medianLogarithm(double degrees_of_freedom) { return 3 * std::log(1 - 2 / (9 * degrees_of_freedom)); }
double varianceOfLogarithm(double degrees_of_freedom) {
  return 2 / degrees_of_freedom + 2 / (degrees_of_freedom * degrees_of_freedom);
}
// Inverts varianceOfLogarithm().
double degreesOfFreedom(double variance) {
  return variance > 0 ? std::min((1 + std::sqrt(1 + 2 * variance)) / variance, kGaussianDegrees)
                      : kGaussianDegrees;
}

// Upper bound of a variance estimated from n values: two standard deviations above its expectation.
double upperBound(double variance, size_t n) { return variance * (1 + 4.6 / std::sqrt(n)); }

// Ratio of a Gaussian's variance to the squared scale of a Student's t distribution (3 dimensions), such that
// both have the probability kTailProbability outside the same region.
double tailFactor(double degrees_of_freedom) {
  if (degrees_of_freedom >= kGaussianDegrees) return 1.0;
  const boost::math::fisher_f t(3, degrees_of_freedom);
  const boost::math::chi_squared gaussian(3);
  return 3 * quantile(complement(t, kTailProbability)) / quantile(complement(gaussian, kTailProbability));
}

double limitedScale(double variance) { return std::clamp(std::sqrt(variance), kMinScale, kMaxScale); }

}  // namespace

std::vector<ImageNoises> imageNoise(const LocatedPose& pose) {
  std::vector<ImageNoises> cameras;
  const auto n = static_cast<double>(pose.used().size());
  for (const LocatedMarker& marker : pose.markers) {
    if (!marker.used) continue;
    if (marker.camera_index >= cameras.size()) cameras.resize(marker.camera_index + 1);
    ImageNoises& image = cameras[marker.camera_index];
    const double factor = marker.noise_scale * marker.noise_scale;
    image.own.squares += marker.own_squares * factor;
    image.own.degrees_of_freedom += 2;
    if (n < 2) continue;
    image.joint.squares += marker.squared_distance * factor;
    image.joint.degrees_of_freedom += 8 - 6 / n;
  }
  return cameras;
}

void CornerNoise::add(const LocatedPose& pose) {
  const auto images = imageNoise(pose);
  for (size_t i = 0; i < images.size(); ++i) add(i, images[i]);
}

void CornerNoise::add(size_t index, const ImageNoises& image) {
  if (index >= cameras_.size()) cameras_.resize(index + 1);
  cameras_[index].joint.add(image.joint);
  cameras_[index].own.add(image.own);
}

bool CornerNoise::Camera::usesJoint() const {
  return joint.isKnown() && (!own.isKnown() || joint.variance < kMaxExcess * own.variance);
}

CornerNoise::Distribution CornerNoise::Camera::used() const {
  if (usesJoint()) return joint;
  Distribution noise = own;
  if (!joint.isKnown()) noise.tail_factor = 1.0;
  noise.variance = joint.isKnown() ? kMaxExcess * own.variance : std::max(1.0, own.variance);
  return noise;
}

bool CornerNoise::Distribution::isKnown() const { return log_variances.size() >= kMinImages; }

void CornerNoise::Distribution::add(const ImageNoise& image) {
  if (image.degrees_of_freedom == 0) return;
  if (log_variances.size() < kMaxImages) {
    log_variances.push_back(0);
    degrees_of_freedom.push_back(0);
  }
  log_variances[next] = std::log(std::max(image.squares / image.degrees_of_freedom, 1e-6));
  degrees_of_freedom[next] = image.degrees_of_freedom;
  next = (next + 1) % kMaxImages;
  if (isKnown()) fit();
}

// The scatter of the images' log variances, minus the scatter due to the few residuals of each image, is that
// of the distribution.
void CornerNoise::Distribution::fit() {
  std::vector<double> unbiased, deviations;
  double sampling_variance = 0.0;
  for (size_t i = 0; i < log_variances.size(); ++i) {
    unbiased.push_back(log_variances[i] - medianLogarithm(degrees_of_freedom[i]));
    sampling_variance +=
        varianceOfLogarithm(degrees_of_freedom[i]) / static_cast<double>(log_variances.size());
  }
  const double centre = median(unbiased);
  for (const double value : unbiased) deviations.push_back(std::abs(value - centre));
  const double sigma = 1.4826 * median(deviations),  // of a Gaussian with this median absolute deviation
      excess = sigma * sigma - upperBound(sampling_variance, deviations.size());
  variance_degrees = degreesOfFreedom(excess);
  tail_factor = tailFactor(variance_degrees);
  variance = std::clamp(std::exp(centre + medianLogarithm(variance_degrees)), kMinScale * kMinScale,
                        kMaxScale * kMaxScale);
}

double CornerNoise::typical(size_t camera) const {
  return camera < cameras_.size() ? std::sqrt(cameras_[camera].used().variance) : 1.0;
}

double CornerNoise::scale(size_t camera) const {
  if (camera >= cameras_.size()) return 1.0;
  const Distribution noise = cameras_[camera].used();
  return limitedScale(noise.variance * noise.tail_factor);
}

double CornerNoise::scale(size_t camera, const ImageNoises& image) const {
  if (camera >= cameras_.size()) return 1.0;
  const Distribution noise = cameras_[camera].used();
  const bool joint = cameras_[camera].usesJoint();
  const ImageNoise& one = joint ? image.joint : image.own;
  if (one.degrees_of_freedom < kMinDegrees) return scale(camera);
  const double squares = joint ? one.squares : kMaxExcess * one.squares;
  return limitedScale((noise.variance_degrees * noise.variance + squares) /
                      (noise.variance_degrees + one.degrees_of_freedom));
}

}  // namespace sextant
