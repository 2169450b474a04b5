// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;

class Update : public testing::TestWithParam<std::string> {};

/// Much is learned at once: a robot that hardly knows its heading sees what it knows exactly, aside far
/// better than in range, so that the covariance of a sighting turns with the heading.
TEST_P(Update, LearnsMuchAtOnceWithoutClaimingTooMuch) {
  LandmarkFilterParams params;
  params.form = GetParam();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const std::vector<PlaneLandmark> landmarks{{{4, 1}, {}}, {{4, -1.5}, {}}};
  const Matrix3d start = Vector3d(0.5, 0.5, 0.25).cwiseAbs2().asDiagonal();
  double nees = 0;
  const int runs = 400;
  for (int run = 0; run < runs; ++run) {
    const Pose2 truth{{0.5 * normal(random), 0.5 * normal(random)}, 0.25 * normal(random)};
    auto filter = LandmarkFilter::make(params, {}, start);
    MatrixXd covariance = 1e-8 * MatrixXd::Identity(7, 7);
    covariance.topLeftCorner<3, 3>() = start;
    filter->setState({}, landmarks, covariance);
    std::vector<KnownSighting> seen;
    for (size_t k = 0; k < landmarks.size(); ++k) {
      const Vector2d z = truth.inverse() * landmarks[k].position;
      const Eigen::Matrix2d axes = rotation2(std::atan2(z.y(), z.x()));
      const Vector2d sigmas(0.08, 0.01);
      PlaneSighting sighting{
          z + axes * sigmas.cwiseProduct(Vector2d(normal(random), normal(random))), {}, Matrix3d::Zero()};
      sighting.covariance.topLeftCorner<2, 2>() = axes * sigmas.cwiseAbs2().asDiagonal() * axes.transpose();
      seen.push_back({k, sighting});
    }
    filter->update(seen);
    Vector3d error;
    error << truth.position - filter->pose().position, wrapped(truth.heading - filter->pose().heading);
    nees += error.dot(filter->covariance({}).ldlt().solve(error)) / (3 * runs);
  }
  EXPECT_GT(nees, 0.8);
  EXPECT_LT(nees, 1.35);
}

INSTANTIATE_TEST_SUITE_P(All, Update, testing::Values("additive", "invariant"));

}  // namespace
}  // namespace sextant
