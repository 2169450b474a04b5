// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_tracks.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

const cv::Size kTrackedImage = {640, 480};

Detection square(int id, double x, double y, double side) {
  Detection found;
  found.key = {"tag36h11", id};
  found.corners = {Eigen::Vector2d(x, y), {x + side, y}, {x + side, y + side}, {x, y + side}};
  return found;
}

FoundMarkers found(const std::vector<Detection>& detections) {
  FoundMarkers markers;
  for (const auto& each : detections) markers.add(each);
  return markers;
}

TEST(MarkerTracks, EachGoesOnAsItMoved) {
  MarkerTracks tracks;
  tracks.update(found({square(1, 100, 100, 50), square(2, 300, 200, 40)}));
  tracks.update(found({square(1, 110, 104, 52), square(2, 295, 200, 40)}));
  const auto expected = tracks.expect(kTrackedImage);
  ASSERT_EQ(expected.size(), 2u);
  EXPECT_EQ(expected[0].corners[0], Eigen::Vector2d(120, 108));
  EXPECT_EQ(expected[0].corners[2], Eigen::Vector2d(174, 162));
  EXPECT_EQ(expected[1].corners[0], Eigen::Vector2d(290, 200));
}

TEST(MarkerTracks, OneSeenOnceMovesAsTheOthersWithMoreRoom) {
  MarkerTracks tracks;
  tracks.update(found({square(1, 100, 100, 50)}));
  tracks.update(found({square(1, 110, 100, 50), square(2, 300, 200, 50)}));
  const auto expected = tracks.expect(kTrackedImage);
  ASSERT_EQ(expected.size(), 2u);
  EXPECT_EQ(expected[1].corners[0], Eigen::Vector2d(310, 200));
  EXPECT_GT(expected[1].margin, expected[0].margin + 5);
}

TEST(MarkerTracks, OneMissedIsExpectedForAWhileFartherOn) {
  MarkerTracks tracks;
  tracks.update(found({square(1, 100, 100, 50)}));
  tracks.update(found({square(1, 110, 100, 50)}));
  tracks.update(found({}));
  ASSERT_EQ(tracks.expect(kTrackedImage).size(), 1u);
  EXPECT_EQ(tracks.expect(kTrackedImage)[0].corners[0], Eigen::Vector2d(130, 100));
  for (int i = 0; i < 5; ++i) tracks.update(found({}));
  EXPECT_TRUE(tracks.expect(kTrackedImage).empty());
}

TEST(MarkerTracks, OneThatLeavesTheImageIsNotLookedFor) {
  MarkerTracks tracks;
  tracks.update(found({square(1, 540, 100, 50)}));
  tracks.update(found({square(1, 580, 100, 50)}));
  EXPECT_TRUE(tracks.expect(kTrackedImage).empty());
}

const std::vector<cv::Rect> kCutOff = {{0, 200, 30, 60}, {300, 0, 40, 20}, {620, 100, 20, 40}};

// As fast as a narrow marker is wide: between two sweeps, one may have come in unseen.
TEST(MarkerTracks, NewOnesEnterWhereTheImageComesFrom) {
  MarkerTracks tracks;
  tracks.update(found({square(1, 100, 100, 50)}));
  EXPECT_TRUE(tracks.entrances(kTrackedImage, kCutOff).empty());
  tracks.update(found({square(1, 120, 100, 50)}));
  const auto strips = tracks.entrances(kTrackedImage, kCutOff);
  ASSERT_EQ(strips.size(), 1u);
  EXPECT_EQ(strips[0].tl(), cv::Point(0, 0));
  EXPECT_EQ(strips[0].height, kTrackedImage.height);
  EXPECT_GT(strips[0].width, 60);  // a marker as large, and its motion
  EXPECT_LT(strips[0].width, 120);
  tracks.update(found({square(1, 100, 80, 50)}));  // back and up: from the right and from below
  ASSERT_EQ(tracks.entrances(kTrackedImage, {}).size(), 2u);
  EXPECT_EQ(tracks.entrances(kTrackedImage, {})[0].br(), cv::Point(640, 480));
  EXPECT_EQ(tracks.entrances(kTrackedImage, {})[1].br(), cv::Point(640, 480));
  tracks.clear();
  EXPECT_TRUE(tracks.entrances(kTrackedImage, kCutOff).empty());
}

TEST(MarkerTracks, WhatComesInSlowlyWasCutOffBefore) {
  MarkerTracks tracks;
  tracks.update(found({square(1, 100, 100, 50)}));
  tracks.update(found({square(1, 105, 100, 50)}));
  EXPECT_TRUE(tracks.entrances(kTrackedImage, {}).empty());
  const auto strips = tracks.entrances(kTrackedImage, kCutOff);
  ASSERT_EQ(strips.size(), 1u);  // what is at the top or on the right goes out, or stays
  EXPECT_EQ(strips[0].x, 0);
  EXPECT_LT(strips[0].y, 200);
  EXPECT_GT(strips[0].br().y, 260);
  EXPECT_LT(strips[0].height, 120);
  EXPECT_TRUE(tracks.entrances(kTrackedImage, {{0, 0, 30, 480}}).empty());  // a wall's edge is no marker
}

TEST(MarkerTracks, TwoPrintsOfOneIdKeepTheirOwnMotion) {
  MarkerTracks tracks;
  tracks.update(found({square(1, 100, 100, 50), square(1, 400, 100, 50)}));
  tracks.update(found({square(1, 110, 100, 50), square(1, 390, 100, 50)}));
  const auto expected = tracks.expect(kTrackedImage);
  ASSERT_EQ(expected.size(), 2u);
  EXPECT_EQ(expected[0].corners[0], Eigen::Vector2d(120, 100));
  EXPECT_EQ(expected[1].corners[0], Eigen::Vector2d(380, 100));
}

}  // namespace
}  // namespace sextant
