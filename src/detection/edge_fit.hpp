// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "edge_curve.hpp"

namespace sextant {

/// Parameters of searchEdge() and fitEdge().
struct EdgeSearch {
  double reach;     ///< search distance to either side along the normal, pixels
  int max_samples;  ///< maximum number of image lines, [8, 100]
  int terms;        ///< fitEdge() fits 2: offset and direction; 3: also curvature
};

/// A fitted edge with its statistics.
struct EdgeFit {
  explicit EdgeFit(const EdgeCurve& start) : curve(start) {}

  EdgeCurve curve;  ///< the fitted curve
  /// Inverse X'X of the normal equations of c[0], c[1], c[2].
  Eigen::Matrix3d normal_inverse = Eigen::Matrix3d::Zero();
  double squared_residuals = 0;  ///< sum of squared residuals, px^2
  double lagged_products = 0;    ///< sum of the products of neighbouring residuals, px^2
  int degrees_of_freedom = 0;    ///< samples minus terms
  double contrast = 0;           ///< grey levels, mean over the samples
  double sharpness = 0;  ///< 1: a step far narrower than the reach; less for wider steps, at least 0.2
  double blur = 0;       ///< standard deviation of the step's profile, pixels
  /// Returns the variance of the offset at s for samples of variance 1.
  double leverage(double s) const;
};

/// Finds an edge to about half a pixel: takes the steepest rise in the direction of the normal on each image
/// line, and fits a straight edge to these points, robust against outliers.
/// @return nothing if fewer than half of the image lines have an inlier
std::optional<EdgeCurve> searchEdge(const cv::Mat& image, const EdgeCurve& start, const EdgeSearch& search);

/// Fits an edge to a few hundredths of a pixel. Every image row (or column) crosses the edge once, so that no
/// pixel is used twice and the noise of the samples is independent. On an image line, the edge is the root x0
/// of
///   sum w(x - x0) (x - x0) I'(x) = 0,  w = (1 - u^2)^2,  u = (x - x0) / reach,
/// computed by one step of Newton's method from the start. The derivative of the left side with respect to
/// x0,
///   -sum (w - 4 u^2 (1 - u^2)) I'(x),
/// is summed over the whole edge. The curve is the least squares fit to these points without outliers.
/// @param start initial curve, with an error of less than half the reach
/// @return nothing if less than half of the edge is visible
std::optional<EdgeFit> fitEdge(const cv::Mat& image, const EdgeCurve& start, const EdgeSearch& search);

/// Locates a step (dark to light or light to dark) near a point.
/// @param reach maximum distance of the step, pixels
/// @param min_contrast grey levels
/// @return distance from the point to the step, pixels, positive in the direction of the curve's normal;
/// nothing if there is no such step
std::optional<double> stepOffset(const cv::Mat& image, const EdgeCurve& along, const Eigen::Vector2d& point,
                                 double reach, double min_contrast);

}  // namespace sextant
