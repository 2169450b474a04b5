// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/geometry/camera.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

/// The picture for the operator: the image with outline, id and frame axes (x red, y green, z blue) of every
/// marker, and a line from each corner to where the marker's own pose has it, 50 times as long (written in
/// the picture, with the RMS over all corner coordinates).
/// @param grey 8-bit; @param width of the picture in pixels, 0: as the image
/// @return BGR
cv::Mat drawMarkers(const cv::Mat& grey, const CameraModel& camera,
                    const std::vector<ObservedMarker>& markers, int width);

}  // namespace sextant
