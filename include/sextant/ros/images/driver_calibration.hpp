// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <string>

namespace sextant {

/// Returns the URL for camera_info_manager: a plain path becomes file://<absolute path>, a URL is unchanged.
/// @throws std::invalid_argument if an existing file is not a calibration; a missing file is allowed, because
/// the calibration tool may write it later
std::string calibrationUrl(const std::string& path_or_url);

/// The camera_info of an image.
struct CheckedCalibration {
  sensor_msgs::CameraInfo info;  ///< calibration to publish; K = 0 without one
  std::string trouble;           ///< message for the user; empty if the calibration fits the image
};

/// Returns the camera's calibration if it is for this image size in pixels, else the size with K = 0, which
/// in ROS means "not calibrated".
CheckedCalibration calibrationFor(const sensor_msgs::CameraInfo& calibration, int width, int height);

}  // namespace sextant
