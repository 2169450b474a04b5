// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/room_texture.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

// 100 x 50 texels on 2 x 1 m, brightness linear in u: 0 at the left, 255 at the right border.
RoomTexture ramp() {
  cv::Mat_<std::uint8_t> texture(50, 100);
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 100; ++x) texture(y, x) = static_cast<std::uint8_t>(std::lround((x + 0.5) * 2.55));
  }
  return RoomTexture(texture, 2.0, 1.0);
}

TEST(RoomTexture, ReturnsTheReflectanceAtAPlaceFromEveryDistance) {
  const RoomTexture texture = ramp();
  for (const float footprint : {0.001F, 0.02F, 0.05F, 0.1F}) {
    for (const float u : {0.3F, 0.77F, 1.0F, 1.5F}) {
      EXPECT_NEAR(texture.level(footprint).reflectance(u, 0.4F), u / 2.0F, 0.004) << u << " at " << footprint;
    }
  }
}

TEST(RoomTexture, AveragesWhatIsFinerThanTheFootprint) {
  cv::Mat_<std::uint8_t> stripes(64, 64);
  for (int x = 0; x < 64; ++x) stripes.col(x).setTo(x % 2 == 0 ? 0 : 200);
  const RoomTexture texture(stripes, 1.0, 1.0);
  EXPECT_NEAR(texture.level(0.07F).reflectance(0.5F, 0.5F), 100.0 / 255.0, 0.01);
  EXPECT_NEAR(texture.level(0.001F).reflectance(8.5F / 64.0F, 0.5F), 0.0, 1e-4);
  EXPECT_NEAR(texture.level(0.001F).reflectance(9.5F / 64.0F, 0.5F), 200.0 / 255.0, 1e-4);
}

TEST(RoomTexture, EndsWithItsBorder) {
  const RoomTexture texture = ramp();
  EXPECT_FLOAT_EQ(texture.level(0.01F).reflectance(-5.0F, -5.0F),
                  texture.level(0.01F).reflectance(0.0F, 0.0F));
  EXPECT_FLOAT_EQ(texture.level(0.01F).reflectance(50.0F, 50.0F),
                  texture.level(0.01F).reflectance(2.0F, 1.0F));
}

TEST(RoomTexture, PaintingsFollowTheirSeed) {
  for (const auto paint : {paintWall, paintFloor, paintCeiling}) {
    const RoomTexture a = paint(6.0, 2.5, 1), same = paint(6.0, 2.5, 1), other = paint(6.0, 2.5, 2);
    int differences = 0;
    for (float u = 0.05F; u < 6.0F; u += 0.1F) {
      for (float v = 0.05F; v < 2.5F; v += 0.1F) {
        const float reflectance = a.level(0.01F).reflectance(u, v);
        EXPECT_EQ(reflectance, same.level(0.01F).reflectance(u, v));
        if (std::abs(reflectance - other.level(0.01F).reflectance(u, v)) > 0.01F) ++differences;
      }
    }
    EXPECT_GT(differences, 100);
  }
}

}  // namespace
}  // namespace sextant
