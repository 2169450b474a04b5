// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "sextant/localization/marker_locator.hpp"

namespace sextant {

/// Corner noise of one image relative to LocatorParams::corner_sigma, computed from residuals.
/// Corners whose own Detection::corner_sigmas is large carry little information about it.
struct ImageNoise {
  double squares = 0.0;             ///< sum of squared distances over the markers, times squared noise_scale
  double degrees_of_freedom = 0.0;  ///< of the sum
};

/// The noise of one image, computed in two ways.
struct ImageNoises {
  /// From LocatedMarker::squared_distance; degrees of freedom: 8 per marker, minus the share of the fitted
  /// pose. None with a single marker. Contains errors of map and calibration.
  ImageNoise joint;
  /// From LocatedMarker::own_squares; degrees of freedom: 2 per marker, 8 coordinates minus 6 of its own
  /// pose.
  ImageNoise own;
};

/// Estimates the corner noise of each camera from the last 200 images. The residuals of joint poses have many
/// degrees of freedom, but errors of the map or the calibration increase them. The residuals of each marker
/// at the pose that fits it best have few, and hardly contain such errors; their variance is too small by up
/// to 45 % where two poses fit about as well. So the former are used, but not if they are more than 2.5 times
/// the latter. From single markers alone, the noise is not estimated smaller than
/// LocatorParams::corner_sigma, and images are not taken to differ: two degrees of freedom each do not show
/// how much. Otherwise they differ, e.g. by motion blur: their variances are modelled as samples
/// of a scaled inverse chi-square distribution, whose scale and degrees of freedom are estimated from the
/// median and the scatter of the variances' logarithms. The errors of one image then follow Student's t
/// distribution (Gelman et al., Bayesian Data Analysis, chapter 5). It is approximated by a Gaussian: 99.75 %
/// of the positions that follow Student's t are within the Gaussian's 99.75 % region.
class CornerNoise {
 public:
  /// Adds the residuals of a pose.
  void add(const LocatedPose& pose);
  /// Adds an image of a camera; ignored if it has no degrees of freedom.
  void add(size_t camera, const ImageNoises& image);

  /// Typical factor on LocatorParams::corner_sigma: the root of the distribution's scale; 1 until there are
  /// 25 images.
  double typical(size_t camera) const;
  /// MarkerView::noise_scale of an image whose own noise is unknown, e.g. with a single marker: from the
  /// Gaussian that approximates Student's t, see above.
  double scale(size_t camera) const;
  /// MarkerView::noise_scale of an image with a noise estimate: the root of the mean of the image's and the
  /// camera's variance, weighted by their degrees of freedom.
  double scale(size_t camera, const ImageNoises& image) const;

  void reset() { cameras_.clear(); }  ///< forgets all images

 private:
  struct Distribution {
    std::vector<double> log_variances;       // of the last images, ring buffer
    std::vector<double> degrees_of_freedom;  // of the same images
    size_t next = 0;                         // index to write in both
    double variance = 1.0;                   // scale of the distribution of the variances
    double variance_degrees = 1e6;           // degrees of freedom of this distribution
    double tail_factor = 1.0;                // variance of the approximating Gaussian, relative to the scale

    void add(const ImageNoise& image);
    void fit();
    bool isKnown() const;
  };
  struct Camera {
    Distribution joint, own;
    bool usesJoint() const;
    Distribution used() const;
  };

  std::vector<Camera> cameras_;
};

/// Computes the noise of each camera's image from the markers of a pose; the index is camera_index.
std::vector<ImageNoises> imageNoise(const LocatedPose& pose);

}  // namespace sextant
