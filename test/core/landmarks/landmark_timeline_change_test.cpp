// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
// LandmarkTimeline where more changes than the robot drives: pauses, leaps, restarts, poses that are told.
#include <gtest/gtest.h>

#include "sextant/landmarks/landmark_timeline.hpp"
#include "test_landmark_drive.hpp"

namespace sextant {
namespace {

TEST(LandmarkTimeline, WhatIsGoneInAPauseOfOdometryIsNotLost) {
  const LandmarkSlam slam({}, Pose2{}, 1e-4 * Matrix3d::Identity());
  LandmarkTimeline timeline({}, slam);
  for (int i = 0; i <= 100; ++i) timeline.odometry(10 + i * kTick, {{0.01 * i, 0}, 0});
  EXPECT_EQ(timeline.see(11.9, {}), Arrival::taken);
  timeline.odometry(20, {{3, 0}, 0});
  EXPECT_NEAR(timeline.now()->T_map_base.position.x(), 3, 1e-9);
  EXPECT_NEAR(timeline.now()->covariance(0, 0), 1e-4 + 3 * 0.03 * 0.03, 1e-6);  // 3 m, way_by_way
  timeline.odometry(30, {{4, 0}, 0});
  EXPECT_NEAR(timeline.now()->T_map_base.position.x(), 4, 1e-9);
}

TEST(LandmarkTimeline, ARestartKeepsTheMap) {
  const Drive drawn = drive(7);
  LandmarkTimeline timeline = timelineOf(drawn);
  run(timeline, drawn, {0});
  const Eigen::MatrixXd covariance = timeline.slam().filter().covariance();
  const Pose2 pose = timeline.slam().filter().pose();
  timeline.restart();
  EXPECT_FALSE(timeline.now());
  EXPECT_TRUE(timeline.odometry(1, {{100, 0}, 0}));  // another clock, another origin
  EXPECT_EQ(timeline.slam().filter().covariance(), covariance);
  EXPECT_LT((timeline.now()->T_map_base.position - pose.position).norm(), 1e-12);
  timeline.odometry(2, {{101, 0}, 0});
  EXPECT_LT((timeline.now()->T_map_base.position - pose * Vector2d(1, 0)).norm(), 1e-12);
  EXPECT_EQ(timeline.see(1.5, {}), Arrival::taken);
}

TEST(LandmarkTimeline, OdometryThatLeapsBeginsAnewAndTheRobotIsSought) {
  const Drive drawn = drive(9);
  LandmarkTimeline timeline = timelineOf(drawn);
  run(timeline, drawn, {0});
  const double last = drawn.odometry.back().first;
  const Pose2 fast = drawn.odometry.back().second * Pose2{{0.9, 0}, 0};
  EXPECT_TRUE(timeline.odometry(last + 0.02, fast));
  EXPECT_EQ(timeline.leaps(), 0);
  EXPECT_TRUE(timeline.odometry(last + 0.07, fast * Pose2{{1.1, 0}, 0}));  // 22 m/s
  EXPECT_EQ(timeline.leaps(), 1);
  EXPECT_TRUE(timeline.slam().isLost());
  EXPECT_EQ(timeline.slam().labels().size(), 6u);
  EXPECT_EQ(timeline.see(last + 0.05, {}), Arrival::too_late);
  EXPECT_TRUE(timeline.odometry(last + 10, fast * Pose2{{30, 0}, 0}));  // a pause
  EXPECT_EQ(timeline.leaps(), 1);
}

TEST(LandmarkTimeline, OfTooManyThatWaitTheLatestAreDropped) {
  const Drive drawn = drive(9);
  LandmarkTimeline timeline = timelineOf(drawn);
  timeline.odometry(drawn.odometry[0].first, drawn.odometry[0].second);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(timeline.see(1000 + i, {}), Arrival::waiting);
  EXPECT_EQ(timeline.waiting(), 100u);
  const Look& soon = drawn.looks[2];
  EXPECT_EQ(timeline.see(soon.stamp, soon.sightings), Arrival::waiting);
  for (const auto& [stamp, pose] : drawn.odometry)
    if (stamp < soon.stamp + 0.05) timeline.odometry(stamp, pose);
  EXPECT_EQ(timeline.waiting(), 99u);
}

TEST(LandmarkTimeline, AChangeIsMadeAtTheLastOdometry) {
  const Drive drawn = drive(8);
  LandmarkTimeline timeline = timelineOf(drawn);
  for (int i = 0; i <= 500; ++i) timeline.odometry(drawn.odometry[i].first, drawn.odometry[i].second);
  EXPECT_EQ(timeline.see(20.3, drawn.looks[0].sightings), Arrival::waiting);
  const Pose2 elsewhere{{-4, 5}, 3};
  timeline.change([&](LandmarkSlam& slam) { slam.setPose(elsewhere, 0.01 * Matrix3d::Identity()); });
  EXPECT_LT((timeline.now()->T_map_base.position - elsewhere.position).norm(), 1e-12);
  EXPECT_LT((timeline.now()->covariance - 0.01 * Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_EQ(timeline.slam().labels().size(), 6u);
  EXPECT_EQ(timeline.see(19.9, drawn.looks[0].sightings), Arrival::too_late);
  timeline.odometry(20.5, drawn.odometry[500].second * Pose2{{1, 0}, 0});
  EXPECT_LT((timeline.now()->T_map_base.position - elsewhere * Vector2d(1, 0)).norm(), 1e-9);
}

}  // namespace
}  // namespace sextant
