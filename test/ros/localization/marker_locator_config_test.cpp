// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/localization/marker_locator_config.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "config_limits.hpp"

namespace sextant {
namespace {

TEST(MarkerLocatorConfig, DefaultsAreThoseOfTheStruct) {
  EXPECT_EQ(MarkerLocatorConfig::__getDefault__().__level__(toConfig(MarkerLocatorParams())), 0u);
}

TEST(MarkerLocatorConfig, EveryValueReachesItsParameter) {
  expectEveryValueReachesItsParameter<MarkerLocatorConfig, MarkerLocatorParams>();
}

TEST(MarkerLocatorConfig, TheOtherParametersStay) {
  MarkerLocatorParams params;
  params.odom_frame = "wheels";
  MarkerLocatorConfig changed = toConfig(params);
  changed.mode = "nearest";
  changed.odometry_recovery = 9;
  changed.floor_height_sigma = 0.02;
  params = withConfig(params, changed);
  EXPECT_EQ(params.localization.locator.mode, "nearest");
  EXPECT_EQ(params.localization.odometry.recovery, 9);
  EXPECT_EQ(params.localization.locator.floor_height_sigma, 0.02);
  EXPECT_EQ(params.odom_frame, "wheels");
}

TEST(MarkerLocatorConfig, ValueOutOfRangeIsRefused) {
  MarkerLocatorConfig changed = toConfig(MarkerLocatorParams());
  changed.mode = "best";
  try {
    withConfig(MarkerLocatorParams(), changed);
    FAIL() << "taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("mode is"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sextant
