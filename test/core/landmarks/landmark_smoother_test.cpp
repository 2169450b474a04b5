// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_smoother.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

OdometryStep step(const Pose2& motion, const Vector3d& deviations) {
  return {motion, deviations.cwiseAbs2().asDiagonal(), motion.position.norm()};
}

PlaneSighting sighting(const Vector2d& position, double sigma, std::optional<double> heading = {}) {
  return {position, heading, sigma * sigma * Matrix3d::Identity()};
}

// Nothing turns: a chain of numbers on each axis, of which the closed form is known.
TEST(LandmarkSmoother, IsTheWeightedMeanWhereAllIsLinear) {
  const Vector3d deviations(0.3, 0.3, 1e-6);
  const std::vector<DriveMoment> drive{{{}, {{0, sighting({2, 1}, 0.4)}}},
                                       {step({{1, 0}, 0}, deviations), {{0, sighting({1.6, 0.8}, 0.2)}}}};
  const auto found = smoothDrive(drive, {{{}, {{0.8, 0.1}, 0}}, {{{1.5, 1.5}, {}}}});
  ASSERT_TRUE(found);
  // The landmark as seen at once, and by way of the step: 0.16 and 0.09 + 0.04; what they disagree by is
  // divided by the variances.
  const Vector2d apart = Vector2d(2.6, 0.8) - Vector2d(2, 1);
  const Vector2d landmark = Vector2d(2, 1) + 0.16 / (0.16 + 0.13) * apart;
  const Vector2d robot = Vector2d(1, 0) - 0.09 / (0.16 + 0.13) * apart;
  EXPECT_LT((found->estimate.landmarks[0].position - landmark).norm(), 1e-5);
  EXPECT_LT((found->estimate.T_map_base[1].position - robot).norm(), 1e-5);
  EXPECT_NEAR(found->cost, 0.5 * apart.squaredNorm() / (0.16 + 0.13), 1e-5);
  EXPECT_EQ(found->estimate.T_map_base[0].position, Vector2d(0, 0));
}

struct Drawn {
  std::vector<DriveMoment> drive;
  DriveEstimate truth, start;
};

/// A round trip among four landmarks, two of them with a heading; the start is dead reckoning.
Drawn loop() {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1);
  const Vector3d deviations(0.02, 0.01, 0.02);
  Drawn drawn;
  drawn.truth.landmarks = {{{3, 1}, {}}, {{-1, 4}, 2.0}, {{1, -2}, {}}, {{4, 4}, -3.1}};
  drawn.start.landmarks = drawn.truth.landmarks;
  Pose2 robot, reckoned;
  for (int i = 0; i < 30; ++i) {
    const Pose2 motion{{0.5, 0}, 2 * M_PI / 29};
    const Pose2 slip{{deviations(0) * noise(random), deviations(1) * noise(random)},
                     deviations(2) * noise(random)};
    if (i > 0) robot = robot * slip * motion, reckoned = reckoned * motion;
    drawn.drive.push_back({step(motion, deviations), {}});
    for (size_t k = i % 2; k < drawn.truth.landmarks.size(); k += 2) {
      const PlaneLandmark seen = seenFrom(robot, drawn.truth.landmarks[k]);
      PlaneSighting z = sighting(seen.position + 0.05 * Vector2d(noise(random), noise(random)), 0.05);
      if (seen.heading) z.heading = wrapped(*seen.heading + 0.05 * noise(random));
      drawn.drive.back().seen.push_back({k, z});
    }
    drawn.truth.T_map_base.push_back(robot);
    drawn.start.T_map_base.push_back(reckoned);
  }
  for (PlaneLandmark& each : drawn.start.landmarks) each.position += Vector2d(0.3, -0.2);
  return drawn;
}

/// Half the sum of squared whitened residuals, as it stands in the header.
double costOf(const std::vector<DriveMoment>& drive, const DriveEstimate& at) {
  double cost = 0;
  for (size_t i = 0; i < drive.size(); ++i) {
    if (i > 0) {
      const Pose2 off = at.T_map_base[i - 1].inverse() * at.T_map_base[i] * drive[i].step.step.inverse();
      const Vector3d w(off.position.x(), off.position.y(), off.heading);
      cost += 0.5 * w.dot(drive[i].step.noise.inverse() * w);
    }
    for (const KnownSighting& each : drive[i].seen) {
      const VectorXd off = differences({each}, {seenFrom(at.T_map_base[i], at.landmarks[each.landmark])});
      cost += 0.5 * off.dot(noiseOf({each}, at.landmarks).ldlt().solve(off));
    }
  }
  return cost;
}

/// The numbers that the smoother may change.
std::vector<double*> freeNumbers(DriveEstimate& estimate) {
  std::vector<double*> all;
  for (size_t i = 1; i < estimate.T_map_base.size(); ++i) {
    Pose2& pose = estimate.T_map_base[i];
    all.insert(all.end(), {&pose.position.x(), &pose.position.y(), &pose.heading});
  }
  for (PlaneLandmark& landmark : estimate.landmarks) {
    all.insert(all.end(), {&landmark.position.x(), &landmark.position.y()});
    if (landmark.heading) all.push_back(&*landmark.heading);
  }
  return all;
}

VectorXd gradientAt(const std::vector<DriveMoment>& drive, DriveEstimate estimate) {
  const std::vector<double*> numbers = freeNumbers(estimate);
  VectorXd gradient(numbers.size());
  const double h = 1e-5;
  for (size_t k = 0; k < numbers.size(); ++k) {
    const double value = *numbers[k];
    *numbers[k] = value + h;
    const double above = costOf(drive, estimate);
    *numbers[k] = value - h;
    gradient(k) = (above - costOf(drive, estimate)) / (2 * h);
    *numbers[k] = value;
  }
  return gradient;
}

TEST(LandmarkSmoother, EndsWhereNothingIsMoreProbable) {
  const Drawn drawn = loop();
  const auto found = smoothDrive(drawn.drive, drawn.start);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->cost, costOf(drawn.drive, found->estimate), 1e-6 * found->cost);
  EXPECT_LT(found->cost, costOf(drawn.drive, drawn.truth));
  EXPECT_LT(gradientAt(drawn.drive, found->estimate).norm(),
            1e-4 * gradientAt(drawn.drive, drawn.start).norm());
  EXPECT_LT((found->estimate.T_map_base.back().position - drawn.truth.T_map_base.back().position).norm(),
            0.1);
  EXPECT_NEAR(wrapped(*found->estimate.landmarks[3].heading + 3.1), 0, 0.1);
  EXPECT_FALSE(found->estimate.landmarks[0].heading);
}

TEST(LandmarkSmoother, LeavesAloneWhatNobodySaw) {
  const std::vector<DriveMoment> drive{{{}, {{1, sighting({2, 0}, 0.1)}}}};
  const auto found = smoothDrive(drive, {{{{1, 1}, 0}}, {{{7, 8}, {}}, {{0, 0}, {}}}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->estimate.landmarks[0].position, Vector2d(7, 8));
  EXPECT_LT((found->estimate.landmarks[1].position - Vector2d(3, 1)).norm(), 1e-6);
  EXPECT_EQ(found->estimate.T_map_base[0].position, Vector2d(1, 1));
  EXPECT_TRUE(smoothDrive({}, {}));
}

TEST(LandmarkSmoother, NamesWhatDoesNotFit) {
  const auto refused = [](const std::vector<DriveMoment>& drive, const DriveEstimate& start) {
    return refusal<std::invalid_argument>([&] { smoothDrive(drive, start); });
  };
  const DriveMoment moment{step({{1, 0}, 0}, {0.1, 0.1, 0.1}), {}};
  EXPECT_EQ(refused({moment, moment}, {{{}}, {}}), "2 moments need as many poses, not 1");
  EXPECT_EQ(refused({{{}, {{3, sighting({1, 0}, 0.1)}}}}, {{{}}, {}}),
            "a sighting is of landmark 3, which is not there");
  const std::string none = "the covariance of a step or a sighting is not positive definite";
  EXPECT_EQ(refused({{{}, {{0, sighting({1, 0}, 0)}}}}, {{{}}, {{}}}), none);
  EXPECT_EQ(refused({moment, {step({{1, 0}, 0}, {0.1, 0.0, 0.1}), {}}}, {{{}, {}}, {}}), none);
}

}  // namespace
}  // namespace sextant
