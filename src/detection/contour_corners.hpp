// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/types.hpp>
#include <vector>

namespace sextant {

/// Corners of a dark or light quad whose edge lies half a pixel beside the outermost dark pixels' centres: a
/// line is fitted to the middle of each side of its contour, neighbours are intersected. A corner that is
/// blunt or hidden does not move them.
/// @param contour as cv::findContours tells it, without approximation
/// @param polygon four of its points, in its order: about the corners
/// @return clockwise, pixels
std::array<cv::Point2f, 4> contourCorners(const std::vector<cv::Point>& contour,
                                          const std::vector<cv::Point>& polygon);

}  // namespace sextant
