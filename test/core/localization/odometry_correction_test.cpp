// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/odometry_correction.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace sextant {
namespace {

using Verdict = OdometryCorrection::Verdict;

Matrix6d spread(double position, double rotation) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(position * position), Eigen::Vector3d::Constant(rotation * rotation);
  return variances.asDiagonal();
}

Vector6d drawn(const Matrix6d& covariance, std::mt19937& random) {
  std::normal_distribution<double> noise(0, 1);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = noise(random);
  return covariance.llt().matrixL() * xi;
}

TEST(OdometryCorrection, KnowsNothingBeforeTheFirstPose) {
  const OdometryCorrection correction({});
  EXPECT_FALSE(correction.predict(Pose::Identity()));
  EXPECT_FALSE(correction.transform());
  EXPECT_FALSE(correction.contradicts(Pose::Identity(), Pose::Identity(), spread(0.1, 0.1)));
}

// x, then 2 m straight on: 10 cm and 30 mrad become sqrt(0.1^2 + 2 * 0.05^2) ahead; aside comes 2 m times the
// heading's 30 mrad.
TEST(OdometryCorrection, PredictionGrowsWithTheWay) {
  OdometryParams params;
  params.position_drift = 0.05;
  params.heading_drift = 1e-6;
  OdometryCorrection correction(params);
  const Pose T_map_base = poseFromXyzRpy({1, 2, 0}, {0, 0, M_PI_2});
  correction.update(Pose::Identity(), T_map_base, spread(0.1, 0.03));
  const auto prior = correction.predict(poseFromXyzRpy({2, 0, 0}, {0, 0, 0}));
  ASSERT_TRUE(prior);
  EXPECT_LT(poseError(poseFromXyzRpy({1, 4, 0}, {0, 0, M_PI_2}), prior->T_map_base).norm(), 1e-12);
  const double ahead = 0.01 + 2 * 0.0025;
  EXPECT_NEAR(prior->covariance(1, 1), ahead, 1e-9);
  EXPECT_NEAR(prior->covariance(0, 0), ahead + 4 * 0.0009, 1e-9);
}

// Two equal measurements at one place: half the variance, plus the share of common errors.
TEST(OdometryCorrection, EqualPosesAreAveraged) {
  OdometryCorrection correction({});
  correction.update(Pose::Identity(), poseFromXyzRpy({1, 0, 0}, {0, 0, 0}), spread(0.1, 0.1));
  correction.update(Pose::Identity(), poseFromXyzRpy({1.1, 0, 0}, {0, 0, 0}), spread(0.1, 0.1));
  EXPECT_NEAR(correction.transform()->translation().x(), 1.05, 1e-9);
  EXPECT_NEAR(correction.predict(Pose::Identity())->covariance(0, 0), 0.005 + 0.0001, 1e-9);
}

TEST(OdometryCorrection, IsConsistentOverADrive) {
  const OdometryParams params;
  std::mt19937 random(3);
  const Matrix6d noise = spread(0.05, 0.02);
  double nees = 0;
  const int runs = 60, steps = 40;
  for (int run = 0; run < runs; ++run) {
    OdometryCorrection correction(params);
    Pose T_map_base = Pose::Identity(), T_odom_base = Pose::Identity();
    for (int i = 0; i < steps; ++i) {
      const Pose step = poseFromXyzRpy({0.3, 0, 0}, {0, 0, 0.1});
      const double way = 0.3, turn = 0.1;
      T_odom_base = T_odom_base * step;
      T_map_base =
          perturbed(T_map_base * step, drawn(spread(params.position_drift * std::sqrt(way),
                                                    std::sqrt(std::pow(params.heading_drift, 2) * way +
                                                              std::pow(params.turn_drift, 2) * turn)),
                                             random));
      correction.update(T_odom_base, perturbed(T_map_base, drawn(noise, random)), noise);
      const auto filtered = correction.predict(T_odom_base);
      const Vector6d error = poseError(T_map_base, filtered->T_map_base);
      nees += error.dot(filtered->covariance.ldlt().solve(error)) / (runs * steps);
    }
  }
  EXPECT_NEAR(nees, 6.0, 0.5);
}

TEST(OdometryCorrection, OneFalsePoseIsRefused) {
  OdometryCorrection correction({});
  const Matrix6d noise = spread(0.05, 0.02);
  correction.update(Pose::Identity(), Pose::Identity(), noise);
  const Pose T_odom_base = poseFromXyzRpy({0.5, 0, 0}, {0, 0, 0}),
             wrong = poseFromXyzRpy({0.5, 3, 0}, {0, 0, 1});
  EXPECT_TRUE(correction.contradicts(T_odom_base, wrong, noise));
  EXPECT_EQ(correction.update(T_odom_base, wrong, noise), Verdict::rejected);
  EXPECT_LT(poseError(Pose::Identity(), *correction.transform()).norm(), 1e-12);
  EXPECT_EQ(correction.update(T_odom_base, T_odom_base, noise), Verdict::accepted);
}

TEST(OdometryCorrection, PosesThatAgreeOverruleTheOdometry) {
  OdometryParams params;
  params.max_rejections = 4;
  OdometryCorrection correction(params);
  const Matrix6d noise = spread(0.05, 0.02);
  correction.update(Pose::Identity(), Pose::Identity(), noise);
  EXPECT_EQ(correction.starts(), 1);
  const Pose carried = poseFromXyzRpy({3, 1, 0}, {0, 0, 2});  // somebody lifted the robot
  Pose T_odom_base = Pose::Identity();
  for (int i = 0; i < 4; ++i) {
    T_odom_base.translation().x() += 0.1;
    EXPECT_EQ(correction.update(T_odom_base, carried * T_odom_base, noise),
              i < 3 ? Verdict::rejected : Verdict::recovered);
  }
  EXPECT_LT(poseError(carried, *correction.transform()).norm(), 1e-9);
  EXPECT_EQ(correction.starts(), 2);
}

TEST(OdometryCorrection, PosesThatContradictOneAnotherTooNeverDo) {
  OdometryCorrection correction({});
  const Matrix6d noise = spread(0.05, 0.02);
  correction.update(Pose::Identity(), Pose::Identity(), noise);
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(
        correction.update(Pose::Identity(), poseFromXyzRpy({3, i % 2 ? 2.0 : -2.0, 0}, {0, 0, 0}), noise),
        Verdict::rejected);
}

TEST(OdometryParams, RefusesWhatIsOutOfRange) {
  OdometryParams params;
  params.position_drift = 0;
  EXPECT_THROW(OdometryCorrection{params}, std::invalid_argument);
  params = {};
  params.max_rejections = 0;
  EXPECT_THROW(OdometryCorrection{params}, std::invalid_argument);
  OdometryCorrection correction({});
  EXPECT_THROW(correction.setParams(params), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
