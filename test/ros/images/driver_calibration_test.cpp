// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/images/driver_calibration.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace sextant {
namespace {

namespace fs = std::filesystem;

sensor_msgs::CameraInfo calibration() {
  sensor_msgs::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.K = {500, 0, 320, 0, 501, 240, 0, 0, 1};
  return info;
}

TEST(Calibration, IsThatOfTheCameraWhereTheSizeFits) {
  const auto checked = calibrationFor(calibration(), 640, 480);
  EXPECT_EQ(checked.info, calibration());
  EXPECT_EQ(checked.trouble, "");
}

TEST(Calibration, OfAnotherSizeIsNeverPassedOn) {
  for (const auto& [width, height] : {std::pair{480, 640}, {640, 481}, {1280, 960}}) {
    const auto checked = calibrationFor(calibration(), width, height);
    EXPECT_EQ(checked.info.K[0], 0.0);
    EXPECT_EQ(checked.info.width, static_cast<unsigned>(width));
    EXPECT_EQ(checked.info.height, static_cast<unsigned>(height));
    EXPECT_NE(checked.trouble.find("640 x 480"), std::string::npos) << checked.trouble;
  }
}

TEST(Calibration, WithoutOneTheSizeIsKnownAndTheUserIsTold) {
  const auto checked = calibrationFor({}, 640, 480);
  EXPECT_EQ(checked.info.width, 640u);
  EXPECT_NE(checked.trouble.find("camera_info_url"), std::string::npos);
}

TEST(Calibration, PathsBecomeUrls) {
  EXPECT_EQ(calibrationUrl(""), "");
  EXPECT_EQ(calibrationUrl("package://robot/camera.yaml"), "package://robot/camera.yaml");
  EXPECT_EQ(calibrationUrl("/not/there/yet.yaml"), "file:///not/there/yet.yaml");
  EXPECT_EQ(calibrationUrl("file:///not/there/yet.yaml"), "file:///not/there/yet.yaml");
  EXPECT_EQ(calibrationUrl("yet.yaml"), "file://" + (fs::current_path() / "yet.yaml").string());
}

TEST(Calibration, WhatIsNoneIsRefusedWithItsPath) {
  char folder[] = "/tmp/sextant_calibration_XXXXXX";
  ASSERT_NE(mkdtemp(folder), nullptr);
  const std::string file = std::string(folder) + "/camera.yaml";
  std::ofstream(file) << "image_width: 640\n";
  const std::string no_file = " is not a calibration file as camera_calibration writes it (.yaml or .ini)";
  const std::pair<std::string, std::string> refused[] = {
      {file, file + no_file},
      {"file://" + file, file + no_file},
      {folder, folder + no_file},
      {"http://a/b.yaml", "must be a path or a URL that begins with file:// or package://"}};
  for (const auto& [url, reason] : refused) {
    try {
      calibrationUrl(url);
      ADD_FAILURE() << url;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace sextant
