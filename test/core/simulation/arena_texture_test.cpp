// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arena_texture.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

// 2 m by 1 m, whose green is u / 2.
ArenaTexture ramp() {
  cv::Mat_<cv::Vec3f> texture(100, 200);
  for (int x = 0; x < 200; ++x) texture.col(x).setTo(cv::Scalar(0.5, (x + 0.5) / 200, 0.25));
  return arenaPyramid(texture);
}

TEST(ArenaTexture, ATexelIsFoundWhereItIsFromEveryDistance) {
  const ArenaTexture texture = ramp();
  for (const float width : {0.001F, 0.02F, 0.05F, 0.1F})
    for (const float u : {0.3F, 0.77F, 1.0F, 1.5F})
      EXPECT_TRUE(arenaTexel(texture, u, 0.4F, width).isApprox(Eigen::Vector3f(0.5F, u / 2, 0.25F), 0.005F))
          << u << " at " << width;
}

TEST(ArenaTexture, WhatIsFinerThanAPixelIsItsMean) {
  cv::Mat_<cv::Vec3f> stripes(64, 64);
  for (int x = 0; x < 64; ++x) stripes.col(x).setTo(cv::Scalar::all(x % 2));
  const ArenaTexture texture = arenaPyramid(stripes);
  EXPECT_NEAR(arenaTexel(texture, 0.3F, 0.3F, 0.05F)[0], 0.5, 1e-6);
  EXPECT_NEAR(arenaTexel(texture, 0.085F, 0.3F, 0.001F)[0], 0, 1e-4);
  EXPECT_NEAR(arenaTexel(texture, 0.095F, 0.3F, 0.001F)[0], 1, 1e-4);
}

TEST(ArenaTexture, ALargeFloorRepeatsItsTexture) {
  const ArenaTexture texture = ramp();
  for (const float u : {0.3F, 1.7F})
    EXPECT_TRUE(
        arenaTexel(texture, u, 0.2F, 0.001F).isApprox(arenaTexel(texture, u + 4, 3.2F, 0.001F), 1e-4F));
}

TEST(ArenaTexture, TexturesHaveTheirSizeAndReflectNoMoreLightThanTheyGet) {
  cv::RNG random(7);
  for (const auto paint : {arenaFloor, arenaWall, arenaCeiling}) {
    const cv::Mat_<cv::Vec3f> texture = paint(3, 2, random);
    EXPECT_EQ(texture.size(), cv::Size(300, 200));
    double low = 0, high = 0;
    cv::minMaxLoc(texture.reshape(1), &low, &high);
    EXPECT_GE(low, 0.02 - 1e-6);
    EXPECT_LE(high, 0.98 + 1e-6);
    EXPECT_GT(high - low, 0.01);
  }
}

}  // namespace
}  // namespace sextant
