// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/geometry/pose_conversions.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "test_poses.hpp"

namespace sextant {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(PoseConversions, PosesComeBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Pose pose = randomPose(random);
    EXPECT_TRUE(fromMsg(toPoseMsg(pose)).isApprox(pose, 1e-12));
    EXPECT_TRUE(fromMsg(toTransformMsg(pose)).isApprox(pose, 1e-12));
  }
}

TEST(PoseConversions, AQuarterTurnAboutZ) {
  const auto msg = toPoseMsg(poseFromXyzRpy({1, 2, 3}, {0, 0, M_PI_2}));
  EXPECT_EQ(msg.position.y, 2);
  EXPECT_NEAR(msg.orientation.z, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(msg.orientation.w, std::sqrt(0.5), 1e-12);
}

TEST(PoseConversions, WhatIsNoPoseIsRefused) {
  EXPECT_THROW(fromMsg(geometry_msgs::Pose()), std::invalid_argument);  // quaternion 0 0 0 0
  geometry_msgs::Pose pose = toPoseMsg(Pose::Identity());
  pose.orientation.w = 1.02;
  EXPECT_THROW(fromMsg(pose), std::invalid_argument);
  pose.orientation.w = kNaN;
  EXPECT_THROW(fromMsg(pose), std::invalid_argument);
  pose = toPoseMsg(Pose::Identity());
  pose.position.z = std::numeric_limits<double>::infinity();
  EXPECT_THROW(fromMsg(pose), std::invalid_argument);
}

TEST(PoseConversions, CovarianceKeepsTheOrderOfPoseWithCovariance) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance(0, 5) = covariance(5, 0) = 7;  // x with rotation about Z
  const auto msg = toPoseWithCovarianceMsg(Pose::Identity(), covariance);
  EXPECT_EQ(msg.covariance[5], 7);
  EXPECT_EQ(msg.covariance[30], 7);
  EXPECT_EQ(fromMsg(msg.covariance), covariance);
}

}  // namespace
}  // namespace sextant
