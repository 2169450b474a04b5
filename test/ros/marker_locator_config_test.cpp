// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/marker_locator_config.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace sextant {
namespace {

TEST(MarkerLocatorConfig, DefaultsAreThoseOfTheStruct) {
  EXPECT_EQ(MarkerLocatorConfig::__getDefault__().__level__(toConfig(MarkerLocatorParams())), 0u);
}

TEST(MarkerLocatorConfig, EveryValueReachesItsParameter) {
  const MarkerLocatorConfig least = MarkerLocatorConfig::__getMin__(),
                            most = MarkerLocatorConfig::__getMax__();
  for (const auto& description : MarkerLocatorConfig::__getParamDescriptions__()) {
    if (description->type == "str") continue;  // no least and most
    for (const MarkerLocatorConfig& limit : {least, most}) {
      dynamic_reconfigure::Config one;
      description->toMessage(one, limit);
      MarkerLocatorConfig wanted = toConfig(MarkerLocatorParams());
      ASSERT_TRUE(description->fromMessage(one, wanted));
      boost::any told, asked;
      description->getValue(toConfig(withConfig(MarkerLocatorParams(), wanted)), told);
      description->getValue(wanted, asked);
      const auto number = [](const boost::any& value) {
        if (const auto* real = boost::any_cast<double>(&value)) return *real;
        if (const auto* whole = boost::any_cast<int>(&value)) return static_cast<double>(*whole);
        return static_cast<double>(boost::any_cast<bool>(value));
      };
      EXPECT_EQ(number(told), number(asked)) << description->name;
    }
  }
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
