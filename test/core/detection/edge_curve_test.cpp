// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "edge_curve.hpp"

#include <gtest/gtest.h>

#include "test_cameras.hpp"

namespace sextant {
namespace {

TEST(EdgeCurve, RunsThroughBothEndsWithItsNormalOnTheAskedSide) {
  const Eigen::Vector2d begin(10, 20), end(50, 20);
  EXPECT_EQ(EdgeCurve(begin, end, true).normal, Eigen::Vector2d(0, -1));
  EdgeCurve curve(begin, end, false);
  EXPECT_EQ(curve.normal, Eigen::Vector2d(0, 1));
  curve.bend(-3);
  EXPECT_EQ(curve.at(-1), begin);
  EXPECT_EQ(curve.at(1), end);
  EXPECT_EQ(curve.at(0), Eigen::Vector2d(30, 23));
}

// Points of a straight line in space, projected one by one, lie on the curve through its ends.
TEST(EdgeCurve, BendsAsTheLensDoes) {
  for (const CameraCalibration& calibration : testCalibrations()) {
    const CameraModel camera(calibration, CameraModel::Image::raw);
    const Eigen::Vector3d a(-0.55, -0.35, 1), b(0.3, -0.4, 1.3);
    EdgeCurve curve(*camera.project(a), *camera.project(b), true);
    ASSERT_TRUE(curve.followLens(camera));
    for (double share = 0; share <= 1; share += 0.1) {
      const Eigen::Vector2d d = *camera.project((1 - share) * a + share * b) - curve.middle;
      const double s = d.dot(curve.half) / curve.half.squaredNorm();
      EXPECT_NEAR(curve.offset(s), d.dot(curve.normal), 0.1) << calibration.distortion_model << share;
    }
  }
}

TEST(EdgeCurve, MeetsItsNeighbour) {
  const EdgeCurve a({0, 0}, {10, 0}, true), b({9, 1}, {9, 12}, true);
  const auto met = intersect(a, b);
  ASSERT_TRUE(met);
  EXPECT_NEAR((*met - Eigen::Vector2d(9, 0)).norm(), 0, 1e-9);
  EXPECT_FALSE(intersect(a, EdgeCurve({0, 3}, {10, 3}, true)));
}

}  // namespace
}  // namespace sextant
