// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "sextant/localization/marker_locator.hpp"

namespace sextant {

/// Corner noise of one image relative to LocatorParams::corner_sigma, computed from the residuals of a pose.
/// Corners whose own Detection::corner_sigmas is large carry little information about it.
struct ImageNoise {
  double squares = 0.0;  ///< sum over the markers: squared Mahalanobis distance times squared noise_scale
  double degrees_of_freedom = 0.0;  ///< 8 per marker, minus the share of the fitted poses
};

/// Estimates the corner noise of each camera from the residuals of joint poses over the last 200 images. The
/// estimate contains image noise, and errors of printed markers, lens and map as far as they are random.
/// Images differ, e.g. by motion blur: their variances are modelled as samples of a scaled inverse chi-square
/// distribution, whose scale and degrees of freedom are estimated from the median and the scatter of the
/// variances' logarithms. The errors of one image then follow Student's t distribution (Gelman et al.,
/// Bayesian Data Analysis, chapter 5). It is approximated by a Gaussian: 99.75 % of the positions that follow
/// Student's t are within the Gaussian's 99.75 % region.
class CornerNoise {
 public:
  /// Adds the residuals of a pose.
  void add(const LocatedPose& pose);
  /// Adds an image of a camera; ignored if it has no degrees of freedom.
  void add(size_t camera, const ImageNoise& image);

  /// Typical factor on LocatorParams::corner_sigma: the root of the distribution's scale; 1 until there are
  /// 25 images.
  double typical(size_t camera) const;
  /// MarkerView::noise_scale of an image whose own noise is unknown, e.g. with a single marker: from the
  /// Gaussian that approximates Student's t, see above.
  double scale(size_t camera) const;
  /// MarkerView::noise_scale of an image with a noise estimate: the root of the mean of the image's and the
  /// camera's variance, weighted by their degrees of freedom.
  double scale(size_t camera, const ImageNoise& image) const;

  void reset() { cameras_.clear(); }  ///< forgets all images

 private:
  struct Camera {
    std::vector<double> log_variances;       // of the last images, ring buffer
    std::vector<double> degrees_of_freedom;  // of the same images
    size_t next = 0;                         // index to write in both
    double variance = 1.0;                   // scale of the distribution of the variances
    double variance_degrees = 1e6;           // degrees of freedom of this distribution
    double tail_factor = 1.0;                // variance of the approximating Gaussian, relative to the scale
  };

  static void fitDistribution(Camera& camera);

  std::vector<Camera> cameras_;
};

/// Computes the noise of each camera's image from the residuals of a pose; the index is camera_index. Empty
/// for a single marker, because the pose absorbs six of its eight residuals.
std::vector<ImageNoise> imageNoise(const LocatedPose& pose);

}  // namespace sextant
