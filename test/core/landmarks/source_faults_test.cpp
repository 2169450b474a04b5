// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/source_faults.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

constexpr PoseSource kMarkers = PoseSource::markers, kLandmarks = PoseSource::landmarks,
                     kPlaces = PoseSource::places;

TEST(SourceFaults, ASourceMayBeWrongOnlyIfAnotherOneSupportsThePose) {
  SourceFaults faults;
  EXPECT_FALSE(faults.mayBeWrong(kMarkers));
  faults.support(kMarkers);
  EXPECT_FALSE(faults.mayBeWrong(kMarkers));
  EXPECT_TRUE(faults.mayBeWrong(kLandmarks));
  faults.drive(100);
  EXPECT_FALSE(faults.mayBeWrong(kLandmarks));
}

TEST(SourceFaults, AnExcludedSourceIsNoSupport) {
  SourceFaults faults;
  faults.support(kLandmarks);
  faults.exclude(kLandmarks);
  EXPECT_FALSE(faults.mayBeWrong(kMarkers));
}

TEST(SourceFaults, AnExclusionIsImprobableUntilOthersConfirmIt) {
  SourceFaults faults;
  EXPECT_EQ(faults.logPrior(), 0);
  faults.exclude(kMarkers);
  EXPECT_TRUE(faults.isExcluded(kMarkers));
  EXPECT_EQ(faults.logPrior(), SourceFaults::kLogWrong);
  EXPECT_LT(faults.compare(kMarkers, false), 0);
  EXPECT_LT(faults.logPrior(), SourceFaults::kLogWrong);
  faults.support(kMarkers);  // its own support is none
  for (int i = 0; i < 2; ++i) faults.support(kPlaces), faults.support(kLandmarks);
  EXPECT_EQ(faults.logPrior(), 0);
  EXPECT_EQ(faults.compare(kMarkers, false), 0);
}

TEST(SourceFaults, OnlyConfirmedExclusionsAreKept) {
  SourceFaults faults;
  faults.exclude(kMarkers);
  for (int i = 0; i < 3; ++i) faults.support(kPlaces);
  faults.exclude(kLandmarks);
  faults.forgetUnconfirmed();
  EXPECT_TRUE(faults.isExcluded(kMarkers));
  EXPECT_FALSE(faults.isExcluded(kLandmarks));
  EXPECT_EQ(faults.logPrior(), 0);
}

TEST(SourceFaults, ASourceThatAgreesAgainIsUsedAgain) {
  SourceFaults faults;
  faults.exclude(kMarkers);
  for (int i = 0; i < 9; ++i) faults.compare(kMarkers, true);
  faults.compare(kMarkers, false);  // in a row
  for (int i = 0; i < 9; ++i) faults.compare(kMarkers, true);
  EXPECT_TRUE(faults.isExcluded(kMarkers));
  faults.compare(kMarkers, true);
  EXPECT_FALSE(faults.isExcluded(kMarkers));
  EXPECT_TRUE(faults.mayBeWrong(kLandmarks));
}

TEST(SourceFaults, ASourceIsUsedAgainIfNoOtherOneSupportsThePose) {
  SourceFaults faults;
  faults.support(kLandmarks);
  faults.exclude(kMarkers);
  for (int i = 0; i < 9; ++i) faults.support(kLandmarks), faults.drive(1);
  EXPECT_TRUE(faults.isExcluded(kMarkers));
  faults.drive(100);
  EXPECT_FALSE(faults.isExcluded(kMarkers));
}

TEST(SourceFaults, AnExcludedSourceIsWrongWhenAnotherOneHasConfirmedIt) {
  SourceFaults faults;
  faults.support(kLandmarks);
  EXPECT_FALSE(faults.isWrong(kMarkers));
  faults.exclude(kMarkers);
  for (int i = 0; i < 7; ++i) faults.support(kLandmarks);
  EXPECT_FALSE(faults.isWrong(kMarkers));
  faults.support(kLandmarks);
  EXPECT_TRUE(faults.isWrong(kMarkers));
  EXPECT_FALSE(faults.isWrong(kLandmarks));
}

TEST(SourceFaults, AreEqualIfTheyExcludeTheSame) {
  SourceFaults one, other;
  one.support(kPlaces);
  EXPECT_TRUE(one == other);
  one.exclude(kMarkers);
  EXPECT_FALSE(one == other);
}

TEST(SourceFaults, AScanOfACameraOfMarkersIsOfMarkers) {
  EXPECT_EQ(sourceOf(Detects::with_id), kMarkers);
  EXPECT_EQ(sourceOf(Detects::all), kLandmarks);
}

}  // namespace
}  // namespace sextant
