// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/observation_2d.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Matrix3d kCovariance = Vector3d(0.01, 0.04, 0.09).asDiagonal();

TEST(Observation2D, ALandmarkIsTransformedToTheRobot) {
  // The robot stands at (1, 2) and looks along y: what is 3 m farther along y is 3 m ahead.
  const Landmark2D seen = toRobotFrame({{1, 2}, M_PI / 2}, {{1, 5}, -M_PI});
  EXPECT_LT((seen.position - Eigen::Vector2d(3, 0)).norm(), 1e-12);
  EXPECT_NEAR(*seen.heading, M_PI / 2, 1e-12);
  EXPECT_FALSE(toRobotFrame({}, {{1, 5}, {}}).heading);
}

TEST(Observation2D, AHeadingIsUsedIfBothHaveOne) {
  const Observation2D with{{1, 2}, 3.0, kCovariance}, without{{4, 6}, {}, kCovariance};
  const std::vector<Landmark2D> landmarks{{{0, 0}, -3.0}, {{1, 1}, {}}};
  EXPECT_EQ(commonDimension(with, landmarks[0]), 3);
  EXPECT_EQ(commonDimension(with, landmarks[1]), 2);
  EXPECT_EQ(commonDimension(without, landmarks[0]), 2);

  const std::vector<AssociatedObservation> seen{{0, with}, {1, without}};
  const Eigen::VectorXd off = innovations(seen, landmarks);
  ASSERT_EQ(off.size(), 5);
  EXPECT_NEAR(off(2), 6 - 2 * M_PI, 1e-12);  // the short way round
  EXPECT_EQ(off.tail<2>(), Eigen::Vector2d(3, 5));

  Eigen::VectorXd variances(5);
  variances << 0.01, 0.04, 0.09, 0.01, 0.04;
  EXPECT_EQ(observationNoise(seen, landmarks), Eigen::MatrixXd(variances.asDiagonal()));
}

}  // namespace
}  // namespace sextant
