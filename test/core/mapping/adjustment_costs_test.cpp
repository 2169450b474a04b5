// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "adjustment_costs.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <vector>

#include "sextant/mapping/lens_correction.hpp"
#include "test_cameras.hpp"
#include "test_costs.hpp"

namespace sextant {
namespace {

const Pose kBase = poseFromXyzRpy({0.7, 0.3, 0.1}, {0.1, -0.2, 0.35});
const Pose kWallMarker = poseFromXyzRpy({3, 0.6, 1}, {M_PI_2, 0.1, -M_PI_2});

Eigen::VectorXd blockOf(const Pose& pose) {
  return Eigen::Map<const Eigen::VectorXd>(blockFromPose(pose).data(), 7);
}

// With every direction coupled to every other.
PosePrior priorAt(const Pose& pose) {
  Matrix6d root = 0.01 * Matrix6d::Identity();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j) root(i, j) = 0.001 * (i - 2 * j);
  return {pose, root * root.transpose()};
}

double mahalanobis(const PosePrior& known, const Pose& pose) {
  const Vector6d e = poseError(known.T_map_base, pose);
  return e.dot(known.covariance.ldlt().solve(e));
}

TEST(PoseBlock, HoldsAPose) {
  EXPECT_TRUE(poseFromBlock(blockFromPose(kWallMarker)).isApprox(kWallMarker, 1e-14));
}

TEST(AdjustmentCosts, CornersAreWhereTheCameraSeesThem) {
  const Pose T_camera_base = poseFromXyzRpy({0.1, 0.02, 0.9}, {-M_PI_2, 0, -M_PI_2}).inverse();
  for (const CameraCalibration& calibration : testCalibrations()) {
    const CameraModel camera(calibration, CameraModel::Image::raw);
    const Corners corners = {Eigen::Vector2d(300, 200), {330, 210}, {325, 240}, {295, 235}};
    const CornerSigmas sigmas = {0.3, 0.5, 1, 2};
    const auto cost = cornersCost(&camera, T_camera_base, 0.2, corners, sigmas);
    const LensCorrection lens = 0.3 * LensCorrection::LinSpaced(-1, 2);
    const std::vector<Eigen::VectorXd> blocks = {blockOf(kBase), blockOf(kWallMarker), lens};
    const Eigen::VectorXd residuals = residualsOf(*cost, blocks);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d point = T_camera_base * kBase.inverse() * kWallMarker * markerCorners(0.2)[k];
      const Eigen::Vector2d pixel = *camera.project(point);
      const Eigen::Vector2d off = pixel + lensModes(camera, pixel) * lens - corners[k];
      EXPECT_LT((residuals.segment<2>(2 * k) - off / sigmas[k]).norm(), 1e-9);
    }
    expectDerivatives(*cost, blocks);
  }
}

TEST(AdjustmentCosts, APriorsSquareIsItsMahalanobisDistance) {
  const PosePrior known = priorAt(kBase);
  const Pose off = perturbed(kBase, (Vector6d() << 0.02, -0.01, 0.03, 0.01, 0.02, -0.02).finished());
  const auto cost = priorCost(known);
  EXPECT_NEAR(residualsOf(*cost, {blockOf(off)}).squaredNorm(), mahalanobis(known, off), 1e-8);
  EXPECT_LT(residualsOf(*cost, {blockOf(kBase)}).norm(), 1e-10);
  expectDerivatives(*cost, {blockOf(off)});
}

TEST(AdjustmentCosts, AStepsSquareIsThatOfTheRelativePose) {
  const PosePrior known = priorAt(poseFromXyzRpy({0.2, 0.01, 0}, {0, 0, 0.1}));
  const Pose next = kBase * poseFromXyzRpy({0.22, 0, 0.01}, {0.01, -0.02, 0.12});
  const auto cost = stepCost(known);
  const std::vector<Eigen::VectorXd> blocks = {blockOf(kBase), blockOf(next)};
  EXPECT_NEAR(residualsOf(*cost, blocks).squaredNorm(), mahalanobis(known, kBase.inverse() * next), 1e-8);
  expectDerivatives(*cost, blocks);
}

TEST(AdjustmentCosts, ALensPriorHoldsEveryCoefficient) {
  const auto cost = lensCost(0.5);
  const LensCorrection lens = LensCorrection::LinSpaced(-1, 2.5);
  EXPECT_LT((residualsOf(*cost, {lens}) - 2 * lens).norm(), 1e-12);
  expectDerivatives(*cost, {lens});
}

TEST(AdjustmentCosts, TheFloorHoldsHeightRollAndPitchOnly) {
  const auto cost = floorCost({0.01, 0.02});
  const auto at = [&](const Pose& pose) { return residualsOf(*cost, {blockOf(pose)}); };
  EXPECT_LT(at(poseFromXyzRpy({3, -2, 0}, {0, 0, 2})).norm(), 1e-12);
  const Eigen::VectorXd tilted = at(poseFromXyzRpy({0, 0, 0.05}, {0.04, 0, 0}));
  EXPECT_NEAR(tilted[0], 5, 1e-12);
  EXPECT_NEAR(tilted.tail<2>().norm(), std::sin(0.04) / 0.02, 1e-12);
  expectDerivatives(*cost, {blockOf(kBase)});
}

}  // namespace
}  // namespace sextant
