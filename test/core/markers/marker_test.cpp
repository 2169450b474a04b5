// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

TEST(Marker, ItsCornersRunFromTheTopLeftClockwiseAsOneLooksAtThePrint) {
  const auto corners = markerCorners(0.2);
  EXPECT_EQ(corners[0], Eigen::Vector3d(-0.1, 0.1, 0));
  EXPECT_EQ(corners[1], Eigen::Vector3d(0.1, 0.1, 0));
  EXPECT_EQ(corners[2], Eigen::Vector3d(0.1, -0.1, 0));
  EXPECT_EQ(corners[3], Eigen::Vector3d(-0.1, -0.1, 0));
}

TEST(Marker, MeasuresItsCornersInAnImage) {
  const Corners corners = {Eigen::Vector2d(0, 0), {12, 0}, {12, 5}, {0, 10}};  // sides 12, 5, 13 and 10
  EXPECT_EQ(centre(corners), Eigen::Vector2d(6, 3.75));
  EXPECT_DOUBLE_EQ(perimeter(corners), 40);
  EXPECT_DOUBLE_EQ(shortestSide(corners), 5);
}

TEST(MarkerKey, IsOrderedByFamilyThenId) {
  EXPECT_LT((MarkerKey{"a", 9}), (MarkerKey{"b", 1}));
  EXPECT_LT((MarkerKey{"a", 1}), (MarkerKey{"a", 2}));
  EXPECT_FALSE((MarkerKey{"a", 1}) == (MarkerKey{"b", 1}));
}

}  // namespace
}  // namespace sextant
