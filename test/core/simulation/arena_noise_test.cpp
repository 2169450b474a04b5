// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arena_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace sextant {
namespace {

TEST(ArenaNoise, NumbersOfNeighbouringSeedsHaveNothingInCommon) {
  constexpr int kSeeds = 2000;
  cv::Mat_<double> first(1, kSeeds);
  for (int seed = 0; seed < kSeeds; ++seed)
    first(seed) = arenaRandom(static_cast<std::uint64_t>(seed)).uniform(0.0, 1.0);
  cv::Scalar mean, deviation;
  cv::meanStdDev(first, mean, deviation);
  EXPECT_NEAR(mean[0], 0.5, 0.02);
  EXPECT_NEAR(deviation[0], std::sqrt(1 / 12.0), 0.01);
  const cv::Mat off = first - 0.5;
  const double common = off.colRange(1, kSeeds).dot(off.colRange(0, kSeeds - 1)) * 12 / (kSeeds - 1);
  EXPECT_NEAR(common, 0, 0.08);
}

TEST(ArenaNoise, IsStandardNormalAndFollowsItsSeed) {
  const std::vector<float> numbers = arenaNoise(3, 100000);
  cv::Scalar mean, deviation;
  cv::meanStdDev(numbers, mean, deviation);
  EXPECT_NEAR(mean[0], 0, 0.015);
  EXPECT_NEAR(deviation[0], 1, 0.015);
  EXPECT_EQ(numbers, arenaNoise(3, 100000));
  EXPECT_NE(numbers, arenaNoise(4, 100000));
}

TEST(ArenaNoise, FramesBeginAllOver) {
  std::set<std::size_t> quarters, begins;
  for (std::uint64_t frame = 0; frame < 100; ++frame) {
    const std::size_t begin = arenaNoiseAt(frame, 1000000);
    EXPECT_LT(begin, 1000000U);
    begins.insert(begin);
    quarters.insert(begin / 250000);
  }
  EXPECT_EQ(quarters.size(), 4U);
  EXPECT_EQ(begins.size(), 100U);
}

}  // namespace
}  // namespace sextant
