// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "sextant/core/marker.hpp"

namespace sextant {

/// The square whose corners are looked for.
struct BorderSquare {
  int modules = 8;            ///< its width; an edge is searched no farther than a module to either side
  bool white_inside = false;  ///< some AprilTag families are white inside their edge and black around it
};

/// Corners at subpixel: the square's four edges are found along their normals as the centroid of the
/// gradient, a line is fitted to each (a parabola where the edge is long enough to show a lens's curvature),
/// neighbours are intersected.
/// @param image 8-bit grey
/// @param corners start, good to about 1.5 px
/// @return nothing where an edge has too little contrast, is partly hidden or has too few pixels
std::optional<Corners> refineCorners(const cv::Mat& image, const Corners& corners,
                                     const BorderSquare& square);

}  // namespace sextant
