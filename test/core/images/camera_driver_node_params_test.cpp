// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/images/camera_driver_node_params.hpp"

#include <gtest/gtest.h>

#include "test_refusal.hpp"

namespace sextant {
namespace {

std::string refused(void (*change)(CameraDriverNodeParams&)) {
  CameraDriverNodeParams params;
  params.source.source = "0";
  change(params);
  return refusal<std::invalid_argument>([&] { validate(params); });
}

TEST(CameraDriverNodeParams, NeedsASource) {
  EXPECT_EQ(refused([](auto&) {}), "accepted");
  EXPECT_NE(refused([](auto& params) { params.source.source = ""; }).find("source"), std::string::npos);
}

TEST(CameraDriverNodeParams, RefusesNamesThatNoFileAndNoDeviceHas) {
  EXPECT_EQ(refused([](auto& params) { params.camera_name = "my camera"; }),
            "camera_name is 'my camera', it must consist of letters, digits and _");
  EXPECT_EQ(refused([](auto& params) { params.source.fourcc = "JPG"; }),
            "fourcc is 'JPG', it must be empty or four letters such as MJPG");
  EXPECT_EQ(refused([](auto& params) { params.source.controls.automatic = {"gain"}; }),
            "automatic contains 'gain', allowed are exposure, focus, white_balance");
  EXPECT_NE(refused([](auto& params) { params.source.controls.exposure = 11.0; }).find("exposure"),
            std::string::npos);
}

}  // namespace
}  // namespace sextant
