// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/lost_watch.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

constexpr int kOld = 10;  // landmarks that were there before, keys 0 to 9

LostWatch watchOf(int lost_after = 10) {
  LostWatch watch(lost_after);
  watch.join(kOld);
  return watch;
}

LostWatch::Look seeing(const std::vector<int>& seen, const std::vector<int>& missed, int unknown = 0) {
  return {seen, missed, 0, unknown, kOld + 5};
}

void look(LostWatch& watch, int times, const LostWatch::Look& look) {
  for (int i = 0; i < times; ++i) watch.look(look);
}

TEST(LostWatch, TwoLandmarksThatAreNotWhereTheyWereMakeARobotLost) {
  LostWatch watch = watchOf();
  look(watch, 9, seeing({}, {1, 2}));
  EXPECT_FALSE(watch.isLost());
  EXPECT_FALSE(watch.isCalm());
  look(watch, 1, seeing({}, {1, 2}));
  EXPECT_TRUE(watch.isLost());
}

TEST(LostWatch, OneThatIsGoneDoesNot) {
  LostWatch watch = watchOf();
  look(watch, 1000, seeing({}, {7}));
  EXPECT_FALSE(watch.isLost());
}

TEST(LostWatch, WhatContradictsTheMapDoes) {
  LostWatch watch = watchOf();
  look(watch, 10, {{}, {}, 1, 0, kOld});
  EXPECT_TRUE(watch.isLost());
}

TEST(LostWatch, LandmarksThatAreWhereTheyShouldBeMakeUpForMisses) {
  LostWatch watch = watchOf();
  for (int i = 0; i < 100; ++i) {
    look(watch, 3, seeing({}, {1, 2}));
    look(watch, 1, seeing({1, 3}, {2}));
  }
  EXPECT_TRUE(watch.isCalm());
}

TEST(LostWatch, OneThatIsSeenAmongStrangersMakesUpForNothing) {
  LostWatch watch = watchOf();
  for (int i = 0; i < 10; ++i) {
    look(watch, 1, seeing({}, {1, 2}));
    look(watch, 1, seeing({1}, {}, 1));
  }
  EXPECT_TRUE(watch.isLost());
}

TEST(LostWatch, ALookThatShowsNothingSaysNothing) {
  LostWatch watch = watchOf();
  look(watch, 9, seeing({}, {1, 2}));
  look(watch, 100, seeing({}, {}));
  EXPECT_FALSE(watch.isLost());
  EXPECT_FALSE(watch.isCalm());
}

TEST(LostWatch, SaysNothingWhereItIsNotAsked) {
  LostWatch watch = watchOf(0);
  look(watch, 1000, {{}, {1, 2, 3}, 5, 0, kOld});
  EXPECT_FALSE(watch.isLost());
}

TEST(LostWatch, WhatIsBegunIsLooseUntilItIsSeenWithWhatWasThere) {
  LostWatch watch = watchOf();
  look(watch, 100, seeing({11, 12}, {}));
  EXPECT_EQ(watch.firstLoose(), kOld);
  look(watch, 2, seeing({3, 11}, {}));
  look(watch, 1, seeing({11}, {}));  // not in a row
  look(watch, 2, seeing({3, 11}, {}));
  look(watch, 1, seeing({3, 11}, {4}));  // as much is missed
  look(watch, 2, seeing({3, 11}, {}));
  EXPECT_EQ(watch.firstLoose(), kOld);
  look(watch, 1, seeing({3, 11}, {}));
  EXPECT_EQ(watch.firstLoose(), kOld + 5);
}

TEST(LostWatch, OnlyWhatWasThereBeforeCounts) {
  LostWatch watch = watchOf();
  look(watch, 10, seeing({11, 12, 13}, {1, 2}));  // loose ones do not make up for it
  EXPECT_TRUE(watch.isLost());
  LostWatch other = watchOf();
  look(other, 10, seeing({}, {11, 12}));
  EXPECT_TRUE(other.isCalm());
}

TEST(LostWatch, TheFirstLandmarksAreTheMap) {
  LostWatch watch(10);
  watch.look({{}, {}, 0, 2, 0});
  watch.look({{}, {}, 0, 0, 3});
  EXPECT_EQ(watch.firstLoose(), 3);
}

}  // namespace
}  // namespace sextant
