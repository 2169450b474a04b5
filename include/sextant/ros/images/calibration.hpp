// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <string>

namespace sextant {

/// The URL that camera_info_manager takes: a plain path becomes file://<absolute path>, the rest is left
/// alone.
/// @throws std::invalid_argument where a file is there but is no calibration; a file that is not there may
/// still be written by the calibration tool
std::string calibrationUrl(const std::string& path_or_url);

struct CheckedCalibration {
  sensor_msgs::CameraInfo info;
  std::string trouble;  ///< what to tell the user; empty where all is well
};

/// The calibration for an image of this size in pixels: that of the camera where it fits, else the bare size
/// with K = 0, which is how ROS says "not calibrated".
CheckedCalibration calibrationFor(const sensor_msgs::CameraInfo& calibration, int width, int height);

}  // namespace sextant
