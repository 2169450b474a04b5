// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_locator_node_params.hpp"

#include <gtest/gtest.h>

#include "test_refusal.hpp"

namespace sextant {
namespace {

TEST(MarkerLocatorNodeParams, PublishesTheTransformThatIsAskedFor) {
  MarkerLocatorNodeParams params;
  params.base_frame = "base_link";
  params.odom_frame = "odom";
  EXPECT_EQ(params.childFrame(), "");
  params.tf_output = "map_to_odom";
  EXPECT_EQ(params.childFrame(), "odom");
  params.tf_output = "map_to_base";
  EXPECT_EQ(params.childFrame(), "base_link");
  EXPECT_NO_THROW(validate(params));
}

TEST(MarkerLocatorNodeParams, RefusesATransformWithoutItsFrames) {
  MarkerLocatorNodeParams params;
  params.tf_output = "map_to_base";
  params.base_frame = "";
  EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }),
            "tf_output map_to_base needs a base_frame");
  params.tf_output = "map_to_odom";
  params.base_frame = params.odom_frame = "odom";
  EXPECT_NE(refusal<std::invalid_argument>([&] { validate(params); }).find("different odom_frame"),
            std::string::npos);
}

TEST(MarkerLocatorNodeParams, NeedsACamera) {
  MarkerLocatorNodeParams params;
  params.cameras.clear();
  EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }),
            "cameras is empty: set at least one topic of markers");
}

}  // namespace
}  // namespace sextant
