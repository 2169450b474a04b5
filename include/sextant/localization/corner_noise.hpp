// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "sextant/localization/marker_locator.hpp"

namespace sextant {

/// What an image's residuals say of its noise, as of LocatorParams::corner_sigma. Where corners tell much
/// noise of their own they say little of what all have in common, and leave the scale about where it was.
struct ImageNoise {
  double squares = 0.0;   ///< sum of squared Mahalanobis distances times their squared noise_scale
  double freedoms = 0.0;  ///< 8 a marker, less the pose's share
};

/// How noisy the corners of each camera are, from what joint poses leave of their residuals over the last few
/// hundred images: noise, print, and as much of lens and map as looks like noise. Images differ, one is
/// blurred and the next is not: their variances are taken for draws of a scaled inverse chi-square
/// distribution, whose scale and degrees of freedom are found from the median and the scatter of their
/// logarithms. So the errors of one image follow Student's t (Gelman et al., Bayesian Data Analysis, chapter
/// 5), and one covariance stands for it that holds 99.75 % of a position as it says.
class CornerNoise {
 public:
  /// To be told every pose.
  void add(const LocatedPose& pose);
  /// What one image of a camera says; without degrees of freedom it says nothing.
  void add(size_t camera, const ImageNoise& image);

  /// Factor on LocatorParams::corner_sigma of most images; 1 until enough was seen.
  double typical(size_t camera) const;
  /// For MarkerView::noise_scale of an image of which nothing else is known, such as one of a single marker:
  /// its errors follow Student's t, and this is the Gaussian beyond whose bound one position of 400 lies, as
  /// it says.
  double scale(size_t camera) const;
  /// And of an image that tells its own noise: that and the usual one, each by its degrees of freedom.
  double scale(size_t camera, const ImageNoise& image) const;

  void reset() { cameras_.clear(); }

 private:
  struct Camera {
    std::vector<double> logarithms;  // of the variances of the last images, a ring
    std::vector<double> freedoms;
    size_t next = 0;
    double variance = 1.0;               // the scale of their distribution
    double distribution_freedoms = 1e6;  // many: images do not differ
    double tail = 1.0;                   // variance of the Gaussian that stands for a draw, over the scale
  };

  static void learn(Camera& camera);

  std::vector<Camera> cameras_;
};

/// What a pose's markers say, camera by camera. Nothing where there is but one marker: its pose takes up six
/// of its eight residuals, and with them what is wrong.
std::vector<ImageNoise> imageNoise(const LocatedPose& pose);

}  // namespace sextant
