// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/source_monitor.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

LandmarkTimeline::Applied scan(double stamp, Detects detects, int associated, int rejected = 0,
                               int missed = 0) {
  LandmarkReport report;
  report.associated = associated, report.rejected = rejected, report.missed = missed;
  return {stamp, detects, report, {}};
}

LandmarkTimeline::Applied image(double stamp, PlaceUse use) { return {stamp, Detects::all, {}, use}; }

TEST(SourceMonitor, NamesTheSourcesThatSupportThePose) {
  SourceMonitor monitor;
  EXPECT_EQ(monitor.supporting(), "none");
  for (int i = 0; i < 5; ++i) monitor.add(scan(0.2 * i, Detects::all, 2));
  monitor.add(scan(1, Detects::with_id, 1));
  monitor.add(image(1, PlaceUse::agrees));
  monitor.add(image(1.5, PlaceUse::unused));
  EXPECT_EQ(monitor.supporting(), "markers (1), landmarks (5), places (1)");
  monitor.add(image(20, PlaceUse::agrees));
  EXPECT_EQ(monitor.supporting(), "places (1)");
  EXPECT_TRUE(monitor.problems().empty());
}

TEST(SourceMonitor, NamesMarkersThatAreElsewhere) {
  SourceMonitor monitor;
  for (int i = 0; i < 5; ++i) monitor.add(scan(0.2 * i, Detects::with_id, 0, 1));
  EXPECT_TRUE(monitor.problems().empty());  // the pose may be wrong
  monitor.add(scan(1, Detects::all, 2));
  ASSERT_EQ(monitor.problems().size(), 1u);
  EXPECT_NE(monitor.problems()[0].find("check the marker map"), std::string::npos);
  for (int i = 0; i < 6; ++i) monitor.add(scan(1 + 0.2 * i, Detects::with_id, 1));
  EXPECT_TRUE(monitor.problems().empty());
}

TEST(SourceMonitor, NamesPlacesThatContradict) {
  SourceMonitor monitor;
  monitor.add(scan(0, Detects::with_id, 1));
  for (int i = 0; i < 3; ++i) monitor.add(image(i, PlaceUse::contradicts));
  EXPECT_TRUE(monitor.problems().empty());  // photos err for some seconds
  monitor.add(image(3, PlaceUse::contradicts));
  ASSERT_EQ(monitor.problems().size(), 1u);
  EXPECT_NE(monitor.problems()[0].find("place map"), std::string::npos);
}

TEST(SourceMonitor, NamesASourceSoonAfterItsLastSupport) {
  SourceMonitor monitor;
  for (int i = 0; i < 20; ++i) {
    monitor.add(scan(0.2 * i, Detects::all, 2));
    monitor.add(scan(0.2 * i, Detects::with_id, 1));
  }
  LandmarkTimeline::Applied excluded = scan(0, Detects::with_id, 0);
  excluded.report.excluded = 1;
  for (int i = 0; i < 3; ++i) excluded.stamp = 4 + 0.2 * i, monitor.add(excluded);
  EXPECT_TRUE(monitor.problems().empty());
  excluded.stamp = 4.6, monitor.add(excluded);
  ASSERT_EQ(monitor.problems().size(), 1u);
  EXPECT_NE(monitor.problems()[0].find("check the marker map"), std::string::npos);
}

TEST(SourceMonitor, NamesASourceThatOnlyAnEarlierPoseAgreedWith) {
  SourceMonitor monitor;
  for (int i = 0; i < 5; ++i) monitor.add(scan(0.2 * i, Detects::with_id, 1));
  LandmarkTimeline::Applied pillars = scan(0, Detects::all, 1);
  pillars.wrong = {PoseSource::markers};
  for (int i = 0; i < 10; ++i) {
    pillars.stamp = 2 + 0.2 * i, monitor.add(pillars);
    EXPECT_TRUE(monitor.problems().empty());  // it may be the best pose for a moment only
  }
  pillars.stamp = 4, monitor.add(pillars);
  ASSERT_EQ(monitor.problems().size(), 1u);
  EXPECT_NE(monitor.problems()[0].find("check the marker map"), std::string::npos);
  pillars.wrong = {}, monitor.add(pillars);
  EXPECT_TRUE(monitor.problems().empty());
}

TEST(SourceMonitor, NamesLandmarksThatWereMoved) {
  SourceMonitor monitor;
  LandmarkTimeline::Applied moved = scan(0, Detects::all, 0, 0, 2);
  moved.report.unexpected = 2;
  for (int i = 0; i < 5; ++i) moved.stamp = i, monitor.add(moved), monitor.add(image(i, PlaceUse::agrees));
  ASSERT_EQ(monitor.problems().size(), 1u);
  EXPECT_NE(monitor.problems()[0].find("were they moved?"), std::string::npos);
}

TEST(SourceMonitor, NamesACameraThatObservesNothing) {
  SourceMonitor monitor;
  for (int i = 0; i < 30; ++i) monitor.add(scan(0.2 * i, Detects::all, 0));  // nothing should be in view
  EXPECT_TRUE(monitor.problems().empty());
  for (int i = 30; i < 60; ++i) monitor.add(scan(0.2 * i, Detects::all, 0, 0, 1));
  ASSERT_EQ(monitor.problems().size(), 1u);
  EXPECT_NE(monitor.problems()[0].find("is the camera covered"), std::string::npos);
}

TEST(SourceMonitor, NamesImagesWithoutContent) {
  SourceMonitor monitor;
  for (int i = 0; i < 3; ++i) monitor.addUnusable(i);
  EXPECT_TRUE(monitor.problems().empty());
  monitor.addUnusable(3);
  ASSERT_EQ(monitor.problems().size(), 1u);
  EXPECT_NE(monitor.problems()[0].find("too little content"), std::string::npos);
  monitor.add(image(4, PlaceUse::agrees));
  EXPECT_TRUE(monitor.problems().empty());
}

TEST(SourceMonitor, AScanOfALostRobotShowsNothing) {
  SourceMonitor monitor;
  LandmarkTimeline::Applied lost = scan(0, Detects::with_id, 0, 1);
  lost.report.lost = true;
  for (int i = 0; i < 9; ++i) monitor.add(lost), monitor.add(image(0, PlaceUse::agrees));
  EXPECT_TRUE(monitor.problems().empty());
}

}  // namespace
}  // namespace sextant
