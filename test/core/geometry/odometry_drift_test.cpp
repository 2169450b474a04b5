// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/odometry_drift.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

TEST(OdometryDrift, GrowsWithDistanceAndTurn) {
  EXPECT_DOUBLE_EQ(driftVariance(0.1, 0.2, 1, 0), 0.01);
  EXPECT_DOUBLE_EQ(driftVariance(0.1, 0.2, 0, 1), 0.04);
  EXPECT_DOUBLE_EQ(driftVariance(0.1, 0.2, 3, 0.5), 0.05);
}

}  // namespace
}  // namespace sextant
