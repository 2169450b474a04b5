// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/pose2.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

namespace sextant {
namespace {

Eigen::Matrix3d matrix(const Pose2& pose) {
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(pose.heading).toRotationMatrix();
  T.topRightCorner<2, 1>() = pose.position;
  return T;
}

TEST(Pose2, ComposesAsHomogeneousMatrices) {
  const Pose2 a{{1, -2}, 2.5}, b{{0.3, 4}, 1.7};
  EXPECT_TRUE(matrix(a * b).isApprox(matrix(a) * matrix(b), 1e-12));
  EXPECT_TRUE(matrix(a.inverse()).isApprox(matrix(a).inverse(), 1e-12));
  EXPECT_TRUE((a * b.position).isApprox((a * b).position, 1e-12));
  EXPECT_LE(std::abs((a * b).heading), M_PI);
}

TEST(Pose2, WrapsToTheUpperEnd) {
  EXPECT_DOUBLE_EQ(wrapped(M_PI), M_PI);
  EXPECT_DOUBLE_EQ(wrapped(-M_PI), M_PI);
  EXPECT_NEAR(wrapped(7.0), 7.0 - 2 * M_PI, 1e-12);
  EXPECT_NEAR(wrapped(-100.25), std::atan2(std::sin(-100.25), std::cos(-100.25)), 1e-12);
}

TEST(Pose2, LeftJacobianIsThatOfTheMatrixExponential) {
  for (const double angle : {0.0, 1e-9, 9e-5, 1.1e-4, -0.3, 3.0}) {
    Eigen::Matrix3d xi = Eigen::Matrix3d::Zero();
    xi << 0, -angle, 0.7, angle, 0, -0.4, 0, 0, 0;
    const Eigen::Matrix3d T = xi.exp();
    EXPECT_TRUE((leftJacobian2(angle) * Eigen::Vector2d(0.7, -0.4)).isApprox(T.topRightCorner<2, 1>(), 1e-12))
        << angle;
    EXPECT_TRUE(rotation2(angle).isApprox(T.topLeftCorner<2, 2>(), 1e-12)) << angle;
  }
}

TEST(Pose2, TheDifferenceOfHeadingsIsWrapped) {
  const Eigen::Vector3d off = difference({{1, 2}, 3}, {{0.5, 3}, -3});
  EXPECT_LT((off - Eigen::Vector3d(0.5, -1, 6 - 2 * M_PI)).norm(), 1e-12);
}

}  // namespace
}  // namespace sextant
