// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/images/driver_calibration.hpp"

#include <camera_calibration_parsers/parse.h>

#include <filesystem>
#include <stdexcept>

namespace sextant {
namespace {

namespace fs = std::filesystem;

std::string sizeText(unsigned width, unsigned height) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels";
}

// camera_info_manager would only log an invalid file and continue without a calibration.
void requireCalibration(const std::string& path) {
  std::string name;
  sensor_msgs::CameraInfo info;
  if (fs::exists(path) &&
      (fs::is_directory(path) || !camera_calibration_parsers::readCalibration(path, name, info)))
    throw std::invalid_argument("camera_info_url: " + path +
                                " is not a calibration file as camera_calibration writes it (.yaml or .ini)");
}

}  // namespace

std::string calibrationUrl(const std::string& path_or_url) {
  const std::string file = "file://";
  if (path_or_url.empty() || path_or_url.rfind("package://", 0) == 0) return path_or_url;
  if (path_or_url.rfind(file, 0) != 0 && path_or_url.find("://") != std::string::npos)
    throw std::invalid_argument("camera_info_url is '" + path_or_url +
                                "', it must be a path or a URL that begins with file:// or package://");
  const bool is_url = path_or_url.rfind(file, 0) == 0;
  const std::string path = is_url ? path_or_url.substr(file.size()) : fs::absolute(path_or_url).string();
  requireCalibration(path);
  return file + path;
}

CheckedCalibration calibrationFor(const sensor_msgs::CameraInfo& calibration, int width, int height) {
  const bool calibrated = calibration.K[0] != 0;
  if (calibrated && static_cast<int>(calibration.width) == width &&
      static_cast<int>(calibration.height) == height)
    return {calibration, {}};
  CheckedCalibration bare;
  bare.info.width = width;
  bare.info.height = height;
  bare.trouble = calibrated
                     ? "the calibration is for " + sizeText(calibration.width, calibration.height) +
                           ", the images have " + sizeText(width, height) +
                           "; camera_info is published without a calibration: set width and height, or "
                           "calibrate again"
                     : "the camera is not calibrated: set camera_info_url to its calibration file, or create "
                       "one with roslaunch sextant calibrate.launch";
  return bare;
}

}  // namespace sextant
