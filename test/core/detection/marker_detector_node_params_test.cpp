// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/detection/marker_detector_node_params.hpp"

#include <gtest/gtest.h>

#include "test_refusal.hpp"

namespace sextant {
namespace {

TEST(MarkerDetectorNodeParams, RefusesFramesThatCouldBeTheMaps) {
  MarkerDetectorNodeParams params;
  EXPECT_NO_THROW(validate(params));
  params.tf_prefix = "";
  EXPECT_NO_THROW(validate(params));  // no frame is published
  params.publish_tf = true;
  EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }),
            "tf_prefix is empty: the frames could have the names of the map's markers");
}

}  // namespace
}  // namespace sextant
