// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/odometry_noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Pose2 expSE2(const Vector3d& w) { return {leftJacobian2(w(2)) * w.head<2>(), w(2)}; }

Vector3d logSE2(const Pose2& pose) {
  Vector3d w;
  w << leftJacobian2(pose.heading).inverse() * pose.position, pose.heading;
  return w;
}

OdometryStep noisy(const Pose2& step, const Vector3d& deviations) {
  Matrix3d noise = deviations.cwiseAbs2().asDiagonal();
  noise(0, 2) = noise(2, 0) = 0.3 * deviations(0) * deviations(2);
  return {step, noise, step.position.norm()};
}

TEST(OdometrySteps, CompositionHasTheCovarianceOfSampledSteps) {
  const std::vector<OdometryStep> steps{noisy({{1, 0.2}, 0.8}, {0.01, 0.02, 0.015}),
                                        noisy({{0.5, -0.1}, -1.9}, {0.02, 0.01, 0.01}),
                                        noisy({{2, 0}, 0.4}, {0.01, 0.01, 0.02})};
  const OdometryStep whole = steps[0] * steps[1] * steps[2];
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1);
  Matrix3d scatter = Matrix3d::Zero();
  const int count = 100000;
  for (int i = 0; i < count; ++i) {
    Pose2 drawn;
    for (const OdometryStep& step : steps) {
      const Vector3d unit{noise(random), noise(random), noise(random)};
      drawn = drawn * expSE2(step.noise.llt().matrixL() * unit) * step.step;
    }
    const Vector3d w = logSE2(drawn * whole.step.inverse());
    scatter += w * w.transpose() / count;
  }
  EXPECT_LT((whole.noise - scatter).norm(), 0.02 * scatter.norm());
  EXPECT_DOUBLE_EQ(whole.distance, steps[0].distance + steps[1].distance + steps[2].distance);
}

OdometryStep inParts(const Pose2& part, int count, const OdometryNoiseParams& params) {
  OdometryStep whole;
  for (int i = 0; i < count; ++i) whole = whole * noisyStep(part, params);
  return whole;
}

// On a line the noise of distance and heading is that of one step; a heading that wanders as Brown's
// particles do takes the robot aside by its integral.
TEST(OdometrySteps, ManySmallStepsAreAsUncertainAsOne) {
  OdometryNoiseParams params;
  const double length = 3;
  const int count = 1000;
  const OdometryStep one = noisyStep({{length, 0}, 0}, params);
  const OdometryStep many = inParts({{length / count, 0}, 0}, count, params);
  EXPECT_NEAR(one.noise(0, 0), std::pow(params.translation_from_translation, 2) * length, 1e-15);
  EXPECT_NEAR(one.noise(1, 1), std::pow(params.lateral_from_translation, 2) * length, 1e-15);
  EXPECT_NEAR(one.noise(2, 2), std::pow(params.rotation_from_translation, 2) * length, 1e-15);
  EXPECT_NEAR(many.noise(0, 0), one.noise(0, 0), 1e-12);
  EXPECT_NEAR(many.noise(2, 2), one.noise(2, 2), 1e-12);
  const double wander = std::pow(params.rotation_from_translation, 2);
  EXPECT_NEAR(many.noise(1, 1), one.noise(1, 1) + wander * std::pow(length, 3) / 3, 1e-5);
  EXPECT_NEAR(many.noise(1, 2), -wander * std::pow(length, 2) / 2, 1e-5);
  EXPECT_NEAR(many.distance, length, 1e-9);

  params.rotation_from_translation = 0;
  EXPECT_LT(
      (inParts({{length / count, 0}, 0}, count, params).noise - noisyStep({{length, 0}, 0}, params).noise)
          .norm(),
      1e-12);
}

TEST(OdometrySteps, ATurnInPlaceIsAsUncertainInParts) {
  OdometryNoiseParams params;
  params.translation_from_rotation = 0;
  const OdometryStep one = noisyStep({{0, 0}, -2}, params), many = inParts({{0, 0}, -0.02}, 100, params);
  EXPECT_NEAR(one.noise(2, 2), std::pow(params.rotation_from_rotation, 2) * 2, 1e-15);
  EXPECT_LT((many.noise - one.noise).norm(), 1e-12);
  params.translation_from_rotation = 0.5;
  EXPECT_NEAR(noisyStep({{0, 0}, -2}, params).noise(0, 0), 0.5, 1e-15);
}

TEST(OdometryNoise, NamesAFieldThatIsOutOfRange) {
  const std::vector<std::pair<std::string, double OdometryNoiseParams::*>> fields{
      {"rotation_from_rotation", &OdometryNoiseParams::rotation_from_rotation},
      {"rotation_from_translation", &OdometryNoiseParams::rotation_from_translation},
      {"translation_from_translation", &OdometryNoiseParams::translation_from_translation},
      {"translation_from_rotation", &OdometryNoiseParams::translation_from_rotation},
      {"lateral_from_translation", &OdometryNoiseParams::lateral_from_translation}};
  validate(OdometryNoiseParams());
  for (const auto& [name, field] : fields)
    for (const double value : {-0.1, 10.1, std::nan("")}) {
      OdometryNoiseParams params;
      params.*field = value;
      EXPECT_EQ(refusal<std::invalid_argument>([&, &params = params] { validate(params); }).find(name), 0u);
    }
}

}  // namespace
}  // namespace sextant
