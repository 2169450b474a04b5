// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/geometry/camera.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

/// Draws detections onto the image: outline, id and axes (x red, y green, z blue) of every marker, and from
/// each corner its reprojection residual, enlarged 50 times. A legend shows this factor and the RMS over all
/// corner coordinates.
/// @param grey 8-bit grey
/// @param width of the drawing, pixels; 0: as the image
/// @return 8-bit BGR
cv::Mat drawMarkers(const cv::Mat& grey, const CameraModel& camera,
                    const std::vector<ObservedMarker>& markers, int width);

}  // namespace sextant
