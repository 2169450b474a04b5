// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/marker_detector_config.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace sextant {
namespace {

TEST(MarkerDetectorConfig, DefaultsAreThoseOfTheStruct) {
  EXPECT_EQ(MarkerDetectorConfig::__getDefault__().__level__(toConfig(MarkerDetectorParams())), 0u);
}

TEST(MarkerDetectorConfig, EveryValueReachesItsParameter) {
  const MarkerDetectorConfig least = MarkerDetectorConfig::__getMin__(),
                             most = MarkerDetectorConfig::__getMax__();
  for (const auto& description : MarkerDetectorConfig::__getParamDescriptions__()) {
    if (description->type == "str") continue;  // no least and most
    for (const MarkerDetectorConfig& limit : {least, most}) {
      dynamic_reconfigure::Config one;
      description->toMessage(one, limit);
      MarkerDetectorConfig wanted = toConfig(MarkerDetectorParams());
      ASSERT_TRUE(description->fromMessage(one, wanted));
      boost::any told, asked;
      description->getValue(toConfig(withConfig(MarkerDetectorParams(), wanted)), told);
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
