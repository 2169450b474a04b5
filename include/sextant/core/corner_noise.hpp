// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "sextant/core/marker_locator.hpp"

namespace sextant {

/// How noisy each camera's corners are, from what joint poses leave of their residuals: the sum of squared
/// Mahalanobis distances over its degrees of freedom, over the last few hundred markers. Holds what corners
/// of several markers do not share: noise, print, and as much of lens and map as looks like noise.
class CornerNoise {
 public:
  /// To be told every pose, located with the scales that this gave.
  void add(const LocatedPose& pose);

  /// For MarkerView::noise_scale; 1 until enough was seen.
  double scale(size_t camera) const;

  void reset() { cameras_.clear(); }

 private:
  struct Camera {
    double squares = 0.0, freedoms = 0.0;  // of residuals over LocatorParams::corner_sigma
  };
  std::vector<Camera> cameras_;
};

}  // namespace sextant
