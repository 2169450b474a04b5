// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/types.hpp>
#include <vector>

namespace sextant {

/// Computes the corners of a dark or light quad. A line is fitted to the middle part of each side of its
/// contour, and adjacent lines are intersected, so that rounded or occluded corners have no effect. The edge
/// lies half a pixel outside the centres of the outermost dark pixels.
/// @param contour from cv::findContours, without approximation
/// @param polygon four points of the contour near the corners, in the order of the contour
/// @return clockwise, pixels
std::array<cv::Point2f, 4> contourCorners(const std::vector<cv::Point>& contour,
                                          const std::vector<cv::Point>& polygon);

}  // namespace sextant
