// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "camera_controls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <opencv2/videoio.hpp>
#include <set>
#include <utility>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Calls = std::vector<std::pair<int, double>>;

/// A camera that keeps values within a range, and refuses those of some properties.
struct FakeCamera {
  std::set<int> refused;
  double largest = 1e6;
  Calls calls;
  std::map<int, double> values;

  CameraProperties properties() {
    return {[this](int property, double value) {
              calls.emplace_back(property, value);
              if (refused.count(property) > 0) return false;
              values[property] = std::min(value, largest);
              return true;
            },
            [this](int property) { return values.count(property) > 0 ? values[property] : -1.0; }};
  }
};

TEST(CameraControls, NothingIsSetByDefault) {
  FakeCamera camera;
  EXPECT_TRUE(applyControls({}, camera.properties()).empty());
  EXPECT_TRUE(camera.calls.empty());
  EXPECT_FALSE(hasControls({}));
}

TEST(CameraControls, ManualValuesFollowTheirModeInUnitsOfTheDevice) {
  CameraControlParams params;
  params.exposure = 0.005;
  params.gain = 3.0;
  params.focus = 0.0;
  params.white_balance = 4600.0;
  FakeCamera camera;
  EXPECT_TRUE(applyControls(params, camera.properties()).empty());
  const Calls expected = {
      {cv::CAP_PROP_AUTO_EXPOSURE, 1.0},  // V4L2_EXPOSURE_MANUAL
      {cv::CAP_PROP_EXPOSURE, 50.0},      // 100 us
      {cv::CAP_PROP_GAIN, 3.0},          {cv::CAP_PROP_AUTOFOCUS, 0.0},        {cv::CAP_PROP_FOCUS, 0.0},
      {cv::CAP_PROP_AUTO_WB, 0.0},       {cv::CAP_PROP_WB_TEMPERATURE, 4600.0}};
  EXPECT_EQ(camera.calls, expected);
  EXPECT_TRUE(hasControls(params));
}

TEST(CameraControls, AutomaticOnesAreSwitchedOn) {
  CameraControlParams params;
  params.automatic = {"white_balance", "exposure", "focus"};
  FakeCamera camera;
  EXPECT_TRUE(applyControls(params, camera.properties()).empty());
  const Calls expected = {{cv::CAP_PROP_AUTO_EXPOSURE, 3.0},  // V4L2_EXPOSURE_APERTURE_PRIORITY
                          {cv::CAP_PROP_AUTOFOCUS, 1.0},
                          {cv::CAP_PROP_AUTO_WB, 1.0}};
  EXPECT_EQ(camera.calls, expected);
}

TEST(CameraControls, WhatTheCameraRefusesOrChangesIsReported) {
  CameraControlParams params;
  params.exposure = 0.02;
  params.gain = 3.0;
  params.automatic = {"focus"};
  FakeCamera camera;
  camera.refused = {cv::CAP_PROP_GAIN, cv::CAP_PROP_AUTOFOCUS};
  camera.largest = 100.0;
  const std::vector<std::string> expected = {"the camera has set 0.01 s instead of exposure of 0.02 s",
                                             "the camera refuses gain of 3",
                                             "the camera refuses automatic focus"};
  EXPECT_EQ(applyControls(params, camera.properties()), expected);
}

TEST(CameraControls, AValueMayBeRoundedToTheStepsOfTheCamera) {
  CameraControlParams params;
  params.white_balance = 4625.0;
  FakeCamera camera;
  camera.largest = 4600.0;
  EXPECT_TRUE(applyControls(params, camera.properties()).empty());
}

TEST(CameraControls, AControlIsManualOrAutomatic) {
  CameraControlParams params;
  params.automatic = {"focus", "exposure"};
  EXPECT_NO_THROW(requireOneMode(params));
  params.exposure = 0.01;
  EXPECT_EQ(refusal<std::invalid_argument>([&] { requireOneMode(params); }),
            "exposure is 0.01 s, so it must not be in automatic");
}

}  // namespace
}  // namespace sextant
