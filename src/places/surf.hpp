// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace sextant {

/// Detects SURF keypoints with dlib (OpenCV's SURF is not free software). A keypoint's size is twice its
/// scale, as with SIFT; its angle is in degrees, clockwise in the image, and 0 if upright.
/// @param image 8-bit grey
/// @param threshold minimum score, on dlib's scale
/// @param upright no orientation; otherwise keypoints too close to the border for one are left out
std::vector<cv::KeyPoint> detectSurf(const cv::Mat& image, double threshold, bool upright);

/// Computes SURF descriptors, CV_32F, n x 64. The image is extended by its border pixels; keypoints whose
/// support region extends farther than the image's longer side are removed.
cv::Mat describeSurf(const cv::Mat& image, std::vector<cv::KeyPoint>& keypoints);

}  // namespace sextant
