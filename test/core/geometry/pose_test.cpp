// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace sextant {
namespace {

Pose randomPose(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-3.1, 3.1);
  const auto draw = [&] { return uniform(random); };
  return poseFromXyzRpy({draw(), draw(), draw()}, {draw(), draw() / 2, draw()});
}

TEST(Pose, FollowsTheFixedAxisConvention) {
  // R = Rz(yaw) Ry(pitch) Rx(roll), multiplied out by hand for 90 degrees each.
  Eigen::Matrix3d expected;
  expected << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const Pose pose = poseFromXyzRpy({1, 2, 3}, {M_PI_2, M_PI_2, M_PI_2});
  EXPECT_TRUE(pose.linear().isApprox(expected, 1e-12));
  EXPECT_EQ(pose.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(Pose, RollPitchYawComeBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Pose pose = randomPose(random);
    const Pose back = poseFromXyzRpy(pose.translation(), rpyFromRotation(pose.linear()));
    EXPECT_TRUE(back.isApprox(pose, 1e-9));
  }
  const Pose locked = poseFromXyzRpy({0, 0, 0}, {0.3, M_PI_2, 0.7});
  EXPECT_TRUE(poseFromXyzRpy({0, 0, 0}, rpyFromRotation(locked.linear())).isApprox(locked, 1e-8));
}

TEST(Pose, ExponentialAndLogarithmAreInverse) {
  for (const double angle : {0.0, 1e-13, 1e-7, 0.5, 3.0, M_PI - 1e-6}) {
    const Eigen::Vector3d delta = angle * Eigen::Vector3d(1, -2, 2) / 3;
    EXPECT_LT((logSO3(expSO3(delta)) - delta).norm(), 1e-9) << angle;
  }
}

TEST(Pose, ErrorIsWhatMovesTheEstimateToTheTruth) {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const Pose truth = randomPose(random), estimate = randomPose(random);
    EXPECT_TRUE(perturbed(estimate, poseError(truth, estimate)).isApprox(truth, 1e-9));
  }
}

TEST(Pose, MeanTakesOppositeQuaternionsAsOneRotation) {
  // Yaws of 170 and -170 degrees average to 180, where added quaternions or angles would give 0.
  const Pose mean = meanPose({poseFromXyzRpy({0, 0, 0}, {0, 0, 170 * M_PI / 180}),
                              poseFromXyzRpy({2, 0, 0}, {0, 0, -170 * M_PI / 180})});
  EXPECT_NEAR(std::abs(rpyFromRotation(mean.linear()).z()), M_PI, 1e-9);
  EXPECT_NEAR(mean.translation().x(), 1.0, 1e-12);
  EXPECT_THROW(meanPose({}), std::invalid_argument);
}

TEST(Pose, KnowsACovariance) {
  Matrix6d matrix = Matrix6d::Identity();
  EXPECT_TRUE(isCovariance(matrix));
  EXPECT_TRUE(isCovariance(Matrix6d::Zero()));
  matrix(0, 1) = 0.5;
  EXPECT_FALSE(isCovariance(matrix));
  matrix(1, 0) = 0.5;
  EXPECT_TRUE(isCovariance(matrix));
  matrix(0, 1) = matrix(1, 0) = 1.5;
  EXPECT_FALSE(isCovariance(matrix));
  EXPECT_FALSE(isCovariance(Matrix6d::Constant(std::nan(""))));
}

TEST(Pose, OfAQuaternionThatIsOne) {
  Eigen::Matrix3d cycle;  // x to y, y to z, z to x: a third of a turn about (1, 1, 1)
  cycle << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  for (const double half : {0.5, -0.5, 0.5 * 1.0099})
    EXPECT_TRUE(poseFromQuaternion({1, 2, 3}, {half, half, half, half}).linear().isApprox(cycle, 1e-15));
  EXPECT_EQ(poseFromQuaternion({1, 2, 3}, {1, 0, 0, 0}).translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_THROW(poseFromQuaternion({1, 2, 3}, {1.011, 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(poseFromQuaternion({1, 2, 3}, {0, 0, 0, 0}, 2), std::invalid_argument);
  EXPECT_THROW(poseFromQuaternion({1, NAN, 3}, {1, 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(poseFromQuaternion({1, 2, 3}, {NAN, 0, 0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
