// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "edge_curve.hpp"

namespace sextant {

/// How an edge is looked for.
struct EdgeSearch {
  double reach;     ///< pixels to either side, along the normal
  int max_samples;  ///< [8, 100]
  int terms;        ///< 2: the curve is shifted and turned; 3: and bent
};

/// Where an edge is, and how well that is known.
struct EdgeFit {
  explicit EdgeFit(const EdgeCurve& start) : curve(start) {}

  EdgeCurve curve;
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  ///< of the normal equations of c[0], c[1], c[2]
  double squares = 0;                                 ///< of the residuals, px^2
  double lagged = 0;                                  ///< sum of the products of neighbouring residuals, px^2
  int freedom = 0;                                    ///< samples less terms
  double contrast = 0;                                ///< grey levels, mean over the samples
  double sharpness = 0;  ///< 1: a step far narrower than the reach; 0: it does not end within the reach

  double blur = 0;  ///< of the step, standard deviation in pixels

  /// Variance of the offset at s where samples have the variance 1.
  double leverage(double s) const;
};

/// To about half a pixel: the steepest rise along the normal on a few image lines, and the straight line that
/// most of them agree on, however the others stand off.
/// @return nothing where fewer than half agree
std::optional<EdgeCurve> searchEdge(const cv::Mat& image, const EdgeCurve& start, const EdgeSearch& search);

/// To a few hundredths of a pixel. Every image row (column, for an edge that runs across) meets the edge
/// once, so that no pixel is read twice and the samples' noise is their own. There the edge is the root x0 of
///   sum w(x - x0) (x - x0) I'(x) = 0,  w = (1 - u^2)^2,  u = (x - x0) / reach,
/// by one step of Newton's method from the start: the slope of the left side is
///   sum (w - 4 u^2 (1 - u^2)) I'(x),
/// taken over the whole edge. Least squares of these offsets, without those that stand off.
/// @param start off by less than half the reach
/// @return nothing where less than half of the edge is seen
std::optional<EdgeFit> fitEdge(const cv::Mat& image, const EdgeCurve& start, const EdgeSearch& search);

/// Signed distance along the curve's normal of a step, dark to light or light to dark, from a point.
/// @param min_contrast grey levels
/// @return nothing where there is no such step within reach (pixels)
std::optional<double> stepOffset(const cv::Mat& image, const EdgeCurve& along, const Eigen::Vector2d& point,
                                 double reach, double min_contrast);

}  // namespace sextant
