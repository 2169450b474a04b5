// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_map.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

TEST(MarkerMap, SetReplacesAndAddRefuses) {
  MarkerMap map;
  map.add({{"tag36h11", 1}, 0.2, "one", Pose::Identity(), Matrix6d::Zero()});
  EXPECT_THROW(map.add({{"tag36h11", 1}, 0.2, "other", Pose::Identity(), Matrix6d::Zero()}),
               std::invalid_argument);
  EXPECT_THROW(map.add({{"tag36h11", 2}, 0.2, "one", Pose::Identity(), Matrix6d::Zero()}),
               std::invalid_argument);
  map.set({{"tag36h11", 1}, 0.4, "one", Pose::Identity(), Matrix6d::Zero()});
  EXPECT_EQ(map.find({"tag36h11", 1})->size, 0.4);
  Matrix6d negative = Matrix6d::Identity();
  negative(0, 0) = -1;
  EXPECT_THROW(map.set({{"tag36h11", 3}, 0.2, "", Pose::Identity(), negative}), std::invalid_argument);
  EXPECT_THROW(map.addFrame({"a b", "map", Pose::Identity()}), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
