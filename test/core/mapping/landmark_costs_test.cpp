// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "landmark_costs.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "test_costs.hpp"

namespace sextant {
namespace {

const Pose2 kFirst{{0.7, -0.3}, 3.0};
const Pose2 kStep{{0.4, 0.1}, 0.5};  // across pi

Eigen::VectorXd blockOf(const Pose2& pose) {
  return Eigen::Vector3d(pose.position.x(), pose.position.y(), pose.heading);
}

Eigen::VectorXd number(double value) { return Eigen::VectorXd::Constant(1, value); }

Eigen::Matrix3d noise() {
  Eigen::Matrix3d root;
  root << 0.1, 0, 0, 0.02, 0.05, 0, -0.01, 0.03, 0.04;
  return root * root.transpose();
}

TEST(LandmarkCosts, AStepsErrorIsThatAtItsBeginning) {
  const OdometryStep step{kStep, noise(), 0.4, 0.5};
  const auto cost = planarStepCost(step);
  const Pose2 w{{0.01, -0.02}, 0.005};  // X' = X exp(w) step
  const Pose2 after = kFirst * Pose2{leftJacobian2(w.heading) * w.position, w.heading} * kStep;
  const Eigen::Vector3d error(w.position.x(), w.position.y(), w.heading);
  const double expected = error.dot(noise().ldlt().solve(error));
  const std::vector<Eigen::VectorXd> blocks{blockOf(kFirst), blockOf(after), number(1), number(1)};
  EXPECT_NEAR(residualsOf(*cost, blocks).squaredNorm(), expected, 0.02 * expected);
  expectDerivatives(*cost, blocks);
}

TEST(LandmarkCosts, ScalesStretchAStep) {
  const auto cost = planarStepCost({kStep, noise(), 0.4, 0.5});
  const Pose2 after = kFirst * Pose2{1.2 * kStep.position, kStep.heading - 0.05};
  const std::vector<Eigen::VectorXd> blocks{blockOf(kFirst), blockOf(after), number(1.2), number(0.9)};
  EXPECT_LT(residualsOf(*cost, blocks).norm(), 1e-9);
  expectDerivatives(*cost, blocks);
}

TEST(LandmarkCosts, ASightingIsThatOfTheSensor) {
  const Pose2 mount{{0.2, -0.1}, 0.3};
  const Landmark2D landmark{{-2, 1}, -3.1};
  Observation2D seen{toRobotFrame(kFirst, landmark).position, toRobotFrame(kFirst, landmark).heading,
                     noise()};
  const auto cost =
      sightingCost({0, 0, mount * (Pose2{{0, 0}, -0.1} * (mount.inverse() * seen)), mount}, landmark);
  const std::vector<Eigen::VectorXd> blocks{blockOf(kFirst), Eigen::Vector3d(-2, 1, -3.1), number(0.1)};
  EXPECT_LT(residualsOf(*cost, blocks).norm(), 1e-9);
  expectDerivatives(*cost, blocks);
  auto off = blocks;
  off[1].head<2>() += rotation2(kFirst.heading) * rotation2(-0.1) * Eigen::Vector2d(0.1, 0.2);
  const Eigen::Vector3d error(0.1, 0.2, 0);
  const double expected = error.dot((noise()).ldlt().solve(error));
  EXPECT_NEAR(residualsOf(*cost, off).squaredNorm(), expected, 1e-9 * expected);
}

TEST(LandmarkCosts, OnlyWhatWasSeenCounts) {
  Observation2D seen{{1, 2}, {}, noise()};
  EXPECT_EQ(sightingCost({0, 0, seen, {}}, {{0, 0}, {}})->num_residuals(), 2);
  EXPECT_EQ(sightingCost({0, 0, seen, {}}, {{0, 0}, 1.0})->num_residuals(), 2);
  seen.heading = 0.5;
  EXPECT_EQ(sightingCost({0, 0, seen, {}}, {{0, 0}, {}})->num_residuals(), 2);
  EXPECT_EQ(sightingCost({0, 0, seen, {}}, {{0, 0}, 1.0})->num_residuals(), 3);
}

TEST(LandmarkCosts, WhatWasKnownCountsWithItsJointCovariance) {
  LandmarkDrives measured;
  measured.first_pose = kFirst;
  measured.known = {{{1, 2}, {}}, {{3, 4}, -3.1}};
  const Eigen::MatrixXd root = Eigen::MatrixXd::Identity(8, 8) + 0.1 * Eigen::MatrixXd::Ones(8, 8);
  measured.covariance_of_known = root * root.transpose();
  const auto cost = knownLandmarksCost(measured);
  const Eigen::VectorXd off = 0.1 * Eigen::VectorXd::LinSpaced(8, -1, 1);
  const Eigen::VectorXd last = Eigen::Vector3d(3, 4, -3.1 + 2 * M_PI);
  const std::vector<Eigen::VectorXd> blocks{blockOf(kFirst) + off.head(3),
                                            Eigen::Vector2d(1, 2) + off.segment(3, 2), last + off.tail(3)};
  EXPECT_NEAR(residualsOf(*cost, blocks).squaredNorm(),
              off.dot(measured.covariance_of_known.ldlt().solve(off)), 1e-6);
  expectDerivatives(*cost, blocks);
}

TEST(LandmarkCosts, AValueCountsInStandardDeviations) {
  const auto cost = valueCost(1, 0.2);
  EXPECT_NEAR(residualsOf(*cost, {number(1.3)})[0], 1.5, 1e-12);
  expectDerivatives(*cost, {number(1.3)});
}

}  // namespace
}  // namespace sextant
