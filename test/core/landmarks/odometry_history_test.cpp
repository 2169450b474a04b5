// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/odometry_history.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace sextant {
namespace {

void expectSame(const Pose2& a, const Pose2& b, double tolerance = 1e-12) {
  EXPECT_LT((a.position - b.position).norm(), tolerance);
  EXPECT_NEAR(wrapped(a.heading - b.heading), 0, tolerance);
}

class Readings : public testing::Test {
 protected:
  Readings() : history_({}, 10.0) {
    history_.add(1, {{1, 0}, M_PI_2});
    history_.add(2, {{1, 2}, M_PI_2});
    history_.add(4, {{1, 2}, -M_PI_2 - 0.5});  // a turn of pi - 0.5 to the left, through pi
  }
  OdometryHistory history_;
};

TEST_F(Readings, AreInterpolatedLinearly) {
  expectSame(*history_.at(1), {{1, 0}, M_PI_2});
  expectSame(*history_.at(1.25), {{1, 0.5}, M_PI_2});
  expectSame(*history_.at(3), {{1, 2}, M_PI_2 + (M_PI - 0.5) / 2});
  expectSame(*history_.at(4), {{1, 2}, -M_PI_2 - 0.5});
}

TEST_F(Readings, GiveTheMotionBetweenTwoStamps) {
  for (const auto& [from, to] : {std::pair(1.0, 4.0), {1.5, 3.5}, {1.2, 1.7}, {2.0, 2.0}, {1.0, 2.0}}) {
    const auto step = history_.between(from, to);
    ASSERT_TRUE(step);
    expectSame(step->step, history_.at(from)->inverse() * *history_.at(to));
  }
  const auto whole = history_.between(1, 4);
  const OdometryStep parts = *history_.between(1, 2) * *history_.between(2, 4);
  EXPECT_LT((whole->noise - parts.noise).norm(), 1e-15);
  EXPECT_NEAR(whole->distance, 2, 1e-12);
  const OdometryStep half = *history_.between(1.5, 2);
  EXPECT_LT((half.noise - noisyStep({{1, 0}, 0}, {}).noise).norm(), 1e-12);
  EXPECT_LT(history_.between(2, 2)->noise.norm(), 1e-15);
}

TEST_F(Readings, GiveNothingOutside) {
  for (const double outside : {0.999, 4.001}) EXPECT_FALSE(history_.at(outside)) << outside;
  EXPECT_FALSE(history_.between(0.9, 2));
  EXPECT_FALSE(history_.between(2, 4.1));
  history_.clear();
  EXPECT_TRUE(history_.empty());
  EXPECT_FALSE(history_.at(1));
  EXPECT_FALSE(history_.between(1, 2));
}

TEST_F(Readings, AreAcceptedInOrderOnly) {
  EXPECT_FALSE(history_.add(4, {{9, 9}, 0}));
  EXPECT_FALSE(history_.add(3.9, {{9, 9}, 0}));
  EXPECT_EQ(history_.last(), 4);
  expectSame(*history_.at(4), {{1, 2}, -M_PI_2 - 0.5});
  EXPECT_TRUE(history_.add(4.1, {}));
}

TEST(OdometryHistory, KeepsItsSpan) {
  OdometryHistory history({}, 2.0);
  for (int i = 0; i <= 100; ++i) history.add(0.1 * i, {{0.1 * i, 0}, 0});
  EXPECT_LE(history.first(), 8.0);
  EXPECT_GT(history.first(), 7.8);
  EXPECT_TRUE(history.between(8.0, 10.0));
  EXPECT_FALSE(history.between(7.5, 10.0));
  history.add(100, {{10, 0}, 0});  // after a long silence, what it began with is still there
  EXPECT_TRUE(history.between(98, 100));
}

}  // namespace
}  // namespace sextant
