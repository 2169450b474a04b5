// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/reconfigure_values.hpp"

#include <gtest/gtest.h>

#include <boost/any.hpp>
#include <stdexcept>

#include "sextant/MarkerDetectorConfig.h"
#include "sextant/MarkerLocatorConfig.h"
#include "sextant/detection/marker_detector_node_params.hpp"
#include "sextant/localization/marker_locator_node_params.hpp"

namespace sextant {
namespace {

double number(const boost::any& value) {
  if (const auto* real = boost::any_cast<double>(&value)) return *real;
  if (const auto* whole = boost::any_cast<int>(&value)) return static_cast<double>(*whole);
  return static_cast<double>(boost::any_cast<bool>(value));
}

// Sets one value after the other to its limits: toConfig() and withConfig() must take each to its parameter
// and back.
template <typename Config, typename Params>
void expectEveryValueReachesItsParameter() {
  EXPECT_EQ(Config::__getDefault__().__level__(toConfig<Config>(Params())), 0u) << "a default differs";
  for (const auto& description : Config::__getParamDescriptions__()) {
    if (description->type == "str") continue;  // no least and most
    for (const Config& limit : {Config::__getMin__(), Config::__getMax__()}) {
      dynamic_reconfigure::Config one;
      description->toMessage(one, limit);
      Config wanted = toConfig<Config>(Params());
      ASSERT_TRUE(description->fromMessage(one, wanted));
      boost::any set, asked;
      description->getValue(toConfig<Config>(withConfig(Params(), wanted)), set);
      description->getValue(wanted, asked);
      EXPECT_EQ(number(set), number(asked)) << description->name;
    }
  }
}

TEST(ReconfigureValues, EveryValueReachesItsParameter) {
  expectEveryValueReachesItsParameter<MarkerDetectorConfig, MarkerDetectorNodeParams>();
  expectEveryValueReachesItsParameter<MarkerLocatorConfig, MarkerLocatorNodeParams>();
}

TEST(ReconfigureValues, TheOtherParametersStay) {
  MarkerLocatorNodeParams params;
  params.odom_frame = "wheels";
  auto changed = toConfig<MarkerLocatorConfig>(params);
  changed.mode = "nearest";
  changed.odometry_max_rejections = 9;
  changed.floor_height_sigma = 0.02;
  params = withConfig(params, changed);
  EXPECT_EQ(params.localization.locator.mode, "nearest");
  EXPECT_EQ(params.localization.odometry.max_rejections, 9);
  EXPECT_EQ(params.localization.locator.floor_height_sigma, 0.02);
  EXPECT_EQ(params.odom_frame, "wheels");
}

TEST(ReconfigureValues, ValueOutOfRangeIsRefused) {
  auto changed = toConfig<MarkerDetectorConfig>(MarkerDetectorNodeParams());
  changed.decimate = 9.0;
  try {
    withConfig(MarkerDetectorNodeParams(), changed);
    FAIL() << "taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "decimate is 9, allowed is [1, 8]");
  }
}

}  // namespace
}  // namespace sextant
