// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/rate_limit.hpp"

#include <gtest/gtest.h>

#include <random>

namespace sextant {
namespace {

using std::chrono::microseconds;

const RateLimit::Clock::time_point kStart{std::chrono::hours(1)};

/// Number of images that pass in ten seconds. @param jitter of each, seconds, uniform to both sides
int passed(double camera_rate, double rate, double jitter) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> late(-jitter, jitter);
  RateLimit limit;
  int count = 0;
  for (int i = 0; i < 10 * camera_rate; ++i)
    if (limit.passes(kStart + microseconds(static_cast<long>(1e6 * (i / camera_rate + late(random)))), rate))
      ++count;
  return count;
}

TEST(RateLimit, PassesTheAskedRateOfAnyCamera) {
  for (const double camera_rate : {10.0, 12.0, 25.0, 30.0, 100.0})
    for (const double jitter : {0.0, 0.004})
      EXPECT_NEAR(passed(camera_rate, 10.0, jitter), 100, 1) << camera_rate << " Hz, " << jitter;
}

TEST(RateLimit, PassesAllWhereNoneIsAskedOrTheCameraIsSlower) {
  EXPECT_EQ(passed(30.0, 0.0, 0.004), 300);
  EXPECT_EQ(passed(7.0, 10.0, 0.004), 70);
}

TEST(RateLimit, EveryThirdImageOfThriceTheRate) {
  RateLimit limit;
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(limit.passes(kStart + microseconds(33333 * i), 10.0), i % 3 == 0) << i;
}

TEST(RateLimit, AHigherRateCountsAtOnceAndAPauseIsNotCaughtUp) {
  RateLimit limit;
  EXPECT_TRUE(limit.passes(kStart, 0.001));
  EXPECT_FALSE(limit.passes(kStart + microseconds(10000), 10.0));
  EXPECT_TRUE(limit.passes(kStart + microseconds(110000), 10.0));
  int count = 0;
  for (int i = 0; i < 10; ++i) count += limit.passes(kStart + microseconds(60000000 + i * 1000), 10.0);
  EXPECT_LE(count, 2);
}

}  // namespace
}  // namespace sextant
