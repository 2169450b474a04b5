// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/detection/marker_detector_config.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "config_limits.hpp"

namespace sextant {
namespace {

TEST(MarkerDetectorConfig, DefaultsAreThoseOfTheStruct) {
  EXPECT_EQ(MarkerDetectorConfig::__getDefault__().__level__(toConfig(MarkerDetectorParams())), 0u);
}

TEST(MarkerDetectorConfig, EveryValueReachesItsParameter) {
  expectEveryValueReachesItsParameter<MarkerDetectorConfig, MarkerDetectorParams>();
}

TEST(MarkerDetectorConfig, TheOtherParametersStay) {
  MarkerDetectorParams params;
  params.tf_prefix = "of_its_own/";
  MarkerDetectorConfig changed = toConfig(params);
  changed.decimate = 2.5;
  changed.debug_rate = 7.0;
  changed.marker_size = 0.1;
  params = withConfig(params, changed);
  EXPECT_EQ(params.detector.decimate, 2.5);
  EXPECT_EQ(params.debug_rate, 7.0);
  EXPECT_EQ(params.sizes.size, 0.1);
  EXPECT_EQ(params.tf_prefix, "of_its_own/");
}

TEST(MarkerDetectorConfig, ValueOutOfRangeIsRefused) {
  MarkerDetectorConfig changed = toConfig(MarkerDetectorParams());
  changed.decimate = 9.0;
  try {
    withConfig(MarkerDetectorParams(), changed);
    FAIL() << "taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("decimate is 9, allowed is [1, 8]"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace sextant
