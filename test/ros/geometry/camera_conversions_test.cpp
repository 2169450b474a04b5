// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/geometry/camera_conversions.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace sextant {
namespace {

sensor_msgs::CameraInfo someCameraInfo() {
  sensor_msgs::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.D = {0.1, -0.2, 0.003, 0.004, 0.05};
  info.K = {600, 2, 319.5, 0, 610, 239.5, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {500, 0, 315.5, -50, 0, 500, 235.5, 0, 0, 0, 1, 0};
  return info;
}

TEST(CameraConversions, CalibrationIsReadByRows) {
  const CameraCalibration calibration = fromMsg(someCameraInfo());
  EXPECT_EQ(calibration.width, 640);
  EXPECT_EQ(calibration.K(0, 2), 319.5);
  EXPECT_EQ(calibration.K(1, 1), 610);
  EXPECT_EQ(calibration.P(0, 3), -50);
  EXPECT_EQ(calibration.D.size(), 5u);
}

// A region moves the origin; merging 2 x 4 pixels makes one whose centre is theirs.
TEST(CameraConversions, RegionAndBinningKeepEveryRay) {
  sensor_msgs::CameraInfo info = someCameraInfo();
  const CameraModel whole(fromMsg(info), CameraModel::Image::raw);
  info.roi.x_offset = 40;
  info.roi.y_offset = 80;
  info.roi.width = 400;
  info.roi.height = 320;
  info.binning_x = 2;
  info.binning_y = 4;
  const CameraCalibration part = fromMsg(info);
  EXPECT_EQ(part.width, 200);
  EXPECT_EQ(part.height, 80);
  for (const auto kind : {CameraModel::Image::raw, CameraModel::Image::rectified}) {
    info = someCameraInfo();
    const CameraModel full(fromMsg(info), kind), binned(part, kind);
    const Eigen::Vector3d point(0.2, -0.1, 1.0);
    const Eigen::Vector2d pixel = *full.project(point);
    const Eigen::Vector2d expected((pixel.x() - 40 - 0.5) / 2, (pixel.y() - 80 - 1.5) / 4);
    EXPECT_LT((*binned.project(point) - expected).norm(), 1e-9);
  }
}

TEST(CameraConversions, CalibrationsThatCannotBeDoNotBecomeCameras) {
  sensor_msgs::CameraInfo info = someCameraInfo();
  info.binning_x = std::numeric_limits<uint32_t>::max();
  EXPECT_THROW(CameraModel(fromMsg(info), CameraModel::Image::raw), std::invalid_argument);
  info = someCameraInfo();
  info.width = std::numeric_limits<uint32_t>::max();
  EXPECT_THROW(CameraModel(fromMsg(info), CameraModel::Image::raw), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
