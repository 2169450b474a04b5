// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/landmark_slam_node_params.hpp"

#include <gtest/gtest.h>

#include "test_refusal.hpp"

namespace sextant {
namespace {

TEST(LandmarkSlamNodeParams, StartsAtTheOriginOrAtStartPose) {
  LandmarkSlamNodeParams params;
  EXPECT_EQ(params.startPose().position, Eigen::Vector2d(0, 0));
  params.start_pose = {1, 2, 2 * M_PI + 0.5};
  params.pose_sigma = {0.1, 0.2, 0.3};
  EXPECT_EQ(params.startPose().position, Eigen::Vector2d(1, 2));
  EXPECT_NEAR(params.startPose().heading, 0.5, 1e-12);
  EXPECT_TRUE(params.startCovariance().isApprox(
      Eigen::Matrix3d(Eigen::Vector3d(0.01, 0.04, 0.09).asDiagonal()), 1e-12));
}

TEST(LandmarkSlamNodeParams, RefusesTwoFramesWithTheSameName) {
  LandmarkSlamNodeParams params;
  params.odom_frame = params.base_frame = "base_link";
  EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }),
            "odom_frame is 'base_link': map, odometry and base need different frames");
  params.odom_frame = "map";
  EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }),
            "map_frame is 'map': map, odometry and base need different frames");
}

TEST(LandmarkSlamNodeParams, RefusesAPoseThatIsNotThreeNumbers) {
  LandmarkSlamNodeParams params;
  params.start_pose = {1, 2};
  EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }),
            "start_pose has 2 numbers, it must have three: x, y (m) and heading (rad)");
}

}  // namespace
}  // namespace sextant
