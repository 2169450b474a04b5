// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>
#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 7)
#define SEXTANT_ARUCO_IN_OBJDETECT 1
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

namespace sextant {

// OpenCV 4.7 moved ArUco to another module and changed its functions: only this header and its source know
// both.

/// Names of OpenCV's predefined dictionaries.
std::vector<std::string> arucoDictionaries();
/// Creates a dictionary.
/// @throws std::out_of_range for a name that is not in arucoDictionaries()
cv::aruco::Dictionary makeArucoDictionary(const std::string& name);

/// Image of a marker with its border, one pixel per module.
cv::Mat arucoModules(const cv::aruco::Dictionary& dictionary, int id);

/// Searches markers by contours.
/// @param image 8-bit grey
/// @param corners clockwise, pixels
void detectArucoMarkers(const cv::Mat& image, const cv::aruco::Dictionary& dictionary,
                        const cv::aruco::DetectorParameters& parameters,
                        std::vector<std::vector<cv::Point2f>>& corners, std::vector<int>& ids);

}  // namespace sextant
