// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "module_grid.hpp"

#include <gtest/gtest.h>

#include "test_print.hpp"

namespace sextant {
namespace {

const Corners kGridTruth = {Eigen::Vector2d(50.3, 31.7), {104.2, 40.1}, {99.6, 91.4}, {46.8, 84.9}};

// What the top side sees of the bits when it stands this far outward of its place.
std::optional<double> offsetWhenOff(double by) {
  Corners corners = kGridTruth;
  for (const int i : {0, 1}) corners[i].y() -= by;
  const EdgeCurve near(corners[0], corners[1], true), far(corners[2], corners[3], true);
  return ModuleGrid(corners, 0, 8, near, far).bitOffset(photograph(printScene(kGridTruth), {}), 150);
}

TEST(ModuleGrid, LeadsFromSideToSide) {
  const EdgeCurve near(kGridTruth[1], kGridTruth[2], true), far(kGridTruth[3], kGridTruth[0], true);
  const ModuleGrid grid(kGridTruth, 1, 8, near, far);
  EXPECT_LT((grid.at(0, 0) - kGridTruth[1]).norm(), 1e-9);
  EXPECT_LT((grid.at(1, 0) - kGridTruth[2]).norm(), 1e-9);
  EXPECT_LT((grid.at(0, 1) - kGridTruth[0]).norm(), 1e-9);
}

TEST(ModuleGrid, SeesHowFarItIsOff) {
  ASSERT_TRUE(offsetWhenOff(0));
  EXPECT_NEAR(*offsetWhenOff(0), 0, 0.15);
  ASSERT_TRUE(offsetWhenOff(1));
  EXPECT_NEAR(*offsetWhenOff(1), -7.0 / 8, 0.3);
  ASSERT_TRUE(offsetWhenOff(-1));
  EXPECT_NEAR(*offsetWhenOff(-1), 7.0 / 8, 0.3);
}

}  // namespace
}  // namespace sextant
