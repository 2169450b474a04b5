// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace sextant {

/// SURF by dlib (OpenCV's is not free). A keypoint's size is twice its scale, as SIFT's is; its angle is in
/// degrees, clockwise in the picture, 0 where upright; where not, those too near to the border to have one
/// are left out.
std::vector<cv::KeyPoint> detectSurf(const cv::Mat& image, double threshold, bool upright);

/// Rows of 64 of the keypoints. What they see beyond the picture is like its border; those that see farther
/// than the picture is long are taken out.
cv::Mat describeSurf(const cv::Mat& image, std::vector<cv::KeyPoint>& keypoints);

}  // namespace sextant
