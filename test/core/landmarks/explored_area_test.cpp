// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/explored_area.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

LandmarkSensor sensor() {
  LandmarkSensorParams params;
  params.max_range = 6;
  params.field_of_view = 1.0;
  return LandmarkSensor(params);
}

TEST(ExploredArea, CountsWhatIsInView) {
  ExploredArea area;
  area.look({{10, 20}, M_PI / 2}, sensor());
  EXPECT_EQ(area.looks({10, 23}), 1);
  EXPECT_EQ(area.looks({10, 17}), 0);  // behind
  EXPECT_EQ(area.looks({10, 27}), 0);  // out of range
  EXPECT_EQ(area.looks({12, 22}), 0);  // at 45 degrees
  EXPECT_EQ(area.looks({-500, 1e300}), 0);
}

TEST(ExploredArea, CountsALookFromEachDirectionOnce) {
  ExploredArea area;
  for (int i = 0; i < 10; ++i) area.look({{0, 0}, 0}, sensor());
  EXPECT_EQ(area.looks({5, 0}), 1);
  area.look({{0.5, 0}, 0}, sensor());  // motion of 11 % of the distance
  EXPECT_EQ(area.looks({5, 0}), 1);
  area.look({{2, 0}, 0}, sensor());  // 67 %
  EXPECT_EQ(area.looks({5, 0}), 2);
}

TEST(ExploredArea, KeepsItsCountsWhenItGrows) {
  ExploredArea area;
  area.look({{0, 0}, 0}, sensor());
  area.look({{-100, -50}, 0}, sensor());
  area.look({{80, 120}, 0}, sensor());
  for (const Eigen::Vector2d& each :
       {Eigen::Vector2d(4, 0), Eigen::Vector2d(-96, -50), Eigen::Vector2d(84, 120)})
    EXPECT_EQ(area.looks(each), 1);
  EXPECT_EQ(area.looks({-4, 0}), 0);
}

TEST(ExploredArea, IsBounded) {
  ExploredArea area;
  area.look({{0, 0}, 0}, sensor());
  area.look({{1e5, 1e5}, 0}, sensor());  // 200,000 by 200,000 cells
  area.look({{1e30, 0}, 0}, sensor());
  EXPECT_EQ(area.looks({1e5 + 4, 1e5}), 0);
  EXPECT_EQ(area.looks({4, 0}), 1);
}

}  // namespace
}  // namespace sextant
