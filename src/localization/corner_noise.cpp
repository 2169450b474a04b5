// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/corner_noise.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

namespace sextant {
namespace {

constexpr size_t kNoiseImages = 25;  // images before which nothing is said
constexpr size_t kMemory = 200;      // images after which the past is forgotten
constexpr double kOutside = 1.0 / 400;
constexpr double kMany = 1e6;  // degrees of freedom of what is a Gaussian
constexpr double kLeastNoise = 0.05, kMostNoise = 10.0;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Of the logarithm of a chi-square variable over its degrees of freedom: median (Wilson and Hilferty 1931),
// and variance, psi'(n / 2).
double medianLogarithm(double freedoms) { return 3 * std::log(1 - 2 / (9 * freedoms)); }
double varianceOfLogarithm(double freedoms) { return 2 / freedoms + 2 / (freedoms * freedoms); }
double freedomsOf(double variance) {
  return variance > 0 ? std::min((1 + std::sqrt(1 + 2 * variance)) / variance, kMany) : kMany;
}

// What the variance that such a scatter of n values tells reaches by chance: two of its deviations more.
double upper(double variance, size_t n) { return variance * (1 + 4.6 / std::sqrt(n)); }

// By how much a Gaussian's variance must exceed the square of the scale of Student's t so that one position
// of 400 lies beyond the bound that chi-square gives.
double tail(double freedoms) {
  if (freedoms >= kMany) return 1.0;
  const boost::math::fisher_f t(3, freedoms);
  const boost::math::chi_squared gaussian(3);
  return 3 * quantile(complement(t, kOutside)) / quantile(complement(gaussian, kOutside));
}

double limited(double variance) { return std::clamp(std::sqrt(variance), kLeastNoise, kMostNoise); }

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
    image.freedoms += 8 - 6 / n;
  }
  return cameras;
}

void CornerNoise::add(const LocatedPose& pose) {
  const auto images = imageNoise(pose);
  for (size_t i = 0; i < images.size(); ++i) add(i, images[i]);
}

void CornerNoise::add(size_t index, const ImageNoise& image) {
  if (index >= cameras_.size()) cameras_.resize(index + 1);
  if (image.freedoms == 0) return;
  Camera& camera = cameras_[index];
  if (camera.logarithms.size() < kMemory) {
    camera.logarithms.push_back(0);
    camera.freedoms.push_back(0);
  }
  camera.logarithms[camera.next] = std::log(std::max(image.squares / image.freedoms, 1e-6));
  camera.freedoms[camera.next] = image.freedoms;
  camera.next = (camera.next + 1) % kMemory;
  if (camera.logarithms.size() >= kNoiseImages) learn(camera);
}

void CornerNoise::learn(Camera& camera) {
  std::vector<double> centred, away;
  double by_chance = 0.0;
  for (size_t i = 0; i < camera.logarithms.size(); ++i) {
    centred.push_back(camera.logarithms[i] - medianLogarithm(camera.freedoms[i]));
    by_chance += varianceOfLogarithm(camera.freedoms[i]) / static_cast<double>(camera.logarithms.size());
  }
  const double middle = median(centred);
  for (const double value : centred) away.push_back(std::abs(value - middle));
  const double deviation = 1.4826 * median(away),
               excess = deviation * deviation - upper(by_chance, away.size());
  const double freedoms = freedomsOf(excess);
  camera.distribution_freedoms = freedoms;
  camera.tail = tail(freedoms);
  camera.variance = std::clamp(std::exp(middle + medianLogarithm(freedoms)), kLeastNoise * kLeastNoise,
                               kMostNoise * kMostNoise);
}

double CornerNoise::typical(size_t camera) const {
  return camera < cameras_.size() ? std::sqrt(cameras_[camera].variance) : 1.0;
}

double CornerNoise::scale(size_t camera) const {
  if (camera >= cameras_.size()) return 1.0;
  return limited(cameras_[camera].variance * cameras_[camera].tail);
}

double CornerNoise::scale(size_t camera, const ImageNoise& image) const {
  if (camera >= cameras_.size()) return 1.0;
  const double own = cameras_[camera].distribution_freedoms, all = own + image.freedoms;
  return limited((own * cameras_[camera].variance + image.squares) / all);
}

}  // namespace sextant
