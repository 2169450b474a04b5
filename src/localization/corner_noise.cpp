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

std::vector<ImageNoise> imageNoise(const LocatedPose& pose) {
  std::vector<ImageNoise> cameras;
  const double n = static_cast<double>(pose.used().size());
  if (n < 2) return cameras;
  for (const LocatedMarker& marker : pose.markers) {
    if (!marker.used) continue;
    if (marker.camera_index >= cameras.size()) cameras.resize(marker.camera_index + 1);
    ImageNoise& image = cameras[marker.camera_index];
    image.squares += marker.squared_distance * marker.noise_scale * marker.noise_scale;
    image.degrees_of_freedom += 8 - 6 / n;
  }
  return cameras;
}

void CornerNoise::add(const LocatedPose& pose) {
  const auto images = imageNoise(pose);
  for (size_t i = 0; i < images.size(); ++i) add(i, images[i]);
}

void CornerNoise::add(size_t index, const ImageNoise& image) {
  if (index >= cameras_.size()) cameras_.resize(index + 1);
  if (image.degrees_of_freedom == 0) return;
  Camera& camera = cameras_[index];
  if (camera.log_variances.size() < kMaxImages) {
    camera.log_variances.push_back(0);
    camera.degrees_of_freedom.push_back(0);
  }
  camera.log_variances[camera.next] = std::log(std::max(image.squares / image.degrees_of_freedom, 1e-6));
  camera.degrees_of_freedom[camera.next] = image.degrees_of_freedom;
  camera.next = (camera.next + 1) % kMaxImages;
  if (camera.log_variances.size() >= kMinImages) fitDistribution(camera);
}

// The scatter of the images' log variances, minus the scatter due to the few residuals of each image, is that
// of the distribution.
void CornerNoise::fitDistribution(Camera& camera) {
  std::vector<double> unbiased, deviations;
  double sampling_variance = 0.0;
  for (size_t i = 0; i < camera.log_variances.size(); ++i) {
    unbiased.push_back(camera.log_variances[i] - medianLogarithm(camera.degrees_of_freedom[i]));
    sampling_variance +=
        varianceOfLogarithm(camera.degrees_of_freedom[i]) / static_cast<double>(camera.log_variances.size());
  }
  const double centre = median(unbiased);
  for (const double value : unbiased) deviations.push_back(std::abs(value - centre));
  const double sigma = 1.4826 * median(deviations),  // of a Gaussian with this median absolute deviation
      excess = sigma * sigma - upperBound(sampling_variance, deviations.size());
  const double degrees_of_freedom = degreesOfFreedom(excess);
  camera.variance_degrees = degrees_of_freedom;
  camera.tail_factor = tailFactor(degrees_of_freedom);
  camera.variance = std::clamp(std::exp(centre + medianLogarithm(degrees_of_freedom)), kMinScale * kMinScale,
                               kMaxScale * kMaxScale);
}

double CornerNoise::typical(size_t camera) const {
  return camera < cameras_.size() ? std::sqrt(cameras_[camera].variance) : 1.0;
}

double CornerNoise::scale(size_t camera) const {
  if (camera >= cameras_.size()) return 1.0;
  return limitedScale(cameras_[camera].variance * cameras_[camera].tail_factor);
}

double CornerNoise::scale(size_t camera, const ImageNoise& image) const {
  if (camera >= cameras_.size()) return 1.0;
  const double prior_degrees = cameras_[camera].variance_degrees;
  return limitedScale((prior_degrees * cameras_[camera].variance + image.squares) /
                      (prior_degrees + image.degrees_of_freedom));
}

}  // namespace sextant
