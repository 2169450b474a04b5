// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "sextant/core/marker.hpp"

namespace sextant {

/// Corners at subpixel: the black border's four edges are found along their normals as the centroid of the
/// gradient, a line is fitted to each (a parabola where the edge is long enough to show a lens's curvature),
/// neighbours are intersected.
/// @param image 8-bit grey
/// @param corners start, good to about 1.5 px
/// @param modules width of the black border's square in modules, which bounds how far an edge may be searched
/// @return nothing where an edge has too little contrast or too few pixels; the start is then the better
/// answer
std::optional<Corners> refineCorners(const cv::Mat& image, const Corners& corners, int modules);

}  // namespace sextant
