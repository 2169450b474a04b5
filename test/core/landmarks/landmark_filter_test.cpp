// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "test_matrices.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

Observation2D observation(const Vector2d& position, double sigma = 0.1, std::optional<double> heading = {}) {
  return {position, heading, sigma * sigma * Matrix3d::Identity()};
}

OdometryStep step(double x, double y, double heading, double sigma = 0.02) {
  return {{{x, y}, heading}, sigma * sigma * Matrix3d::Identity(), std::hypot(x, y), heading};
}

const Matrix3d kStart = Vector3d(0.04, 0.09, 0.01).asDiagonal();

/// A robot on an arc that observes three landmarks, one with a heading.
LandmarkFilter driven() {
  LandmarkFilter filter({}, {{1, 2}, 0.5}, kStart);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.1);
  const std::vector<Landmark2D> truth{{{4, 2}, {}}, {{3, 6}, 1.0}, {{-1, 4}, {}}};
  Pose2 robot{{1.1, 1.8}, 0.55};
  for (int i = 0; i < 30; ++i) {
    const OdometryStep moved = step(0.1, 0.0, 0.05);
    robot = robot * moved.step;
    filter.predict(moved, 0.1);
    std::vector<AssociatedObservation> seen;
    for (size_t k = 0; k < truth.size(); ++k) {
      Observation2D z =
          observation(robot.inverse() * truth[k].position + Vector2d{noise(random), noise(random)});
      if (truth[k].heading) z.heading = wrapped(*truth[k].heading - robot.heading + noise(random));
      if (k < filter.landmarks().size() && (i + k) % 3 != 0) seen.push_back({k, z});
      if (k == filter.landmarks().size()) filter.add(z);
    }
    filter.update(seen);
  }
  return filter;
}

VectorXd values(const LandmarkFilter& filter) {
  std::vector<double> all{filter.pose().position.x(), filter.pose().position.y(), filter.pose().heading};
  for (const Landmark2D& landmark : filter.landmarks()) {
    all.insert(all.end(), {landmark.position.x(), landmark.position.y()});
    if (landmark.heading) all.push_back(*landmark.heading);
  }
  return Eigen::Map<VectorXd>(all.data(), all.size());
}

TEST(LandmarkFilter, AnExactMapIsRepairedOnce) {
  LandmarkFilter filter({}, {}, kStart);
  filter.setState({}, {{{2, 1}, {}}}, MatrixXd::Zero(5, 5));
  filter.update({{0, observation({2.3, 1})}});
  EXPECT_GE(filter.repairs(), 1);
  EXPECT_LT(filter.pose().position.norm(), 1e-6);
}

// With a heading that is known, everything is linear: the textbook's Kalman filter.
TEST(LandmarkFilter, WithAKnownHeadingEqualsTheKalmanFilter) {
  Matrix3d start = kStart;
  start(2, 2) = 1e-16;
  LandmarkFilter filter({}, {{0, 0}, 0}, start);
  OdometryStep straight = step(1, 0, 0);
  straight.noise = Vector3d(0.01, 0.02, 1e-16).asDiagonal();
  filter.predict(straight);
  filter.add(observation({2, 1}, 0.3));
  filter.predict(straight);
  filter.update({{0, observation({1.2, 1.1}, 0.3)}});

  VectorXd x(4);
  x << 2, 0, 3, 1;
  MatrixXd P = MatrixXd::Zero(4, 4);
  const Vector2d first(0.05, 0.11), second(0.06, 0.13);
  P.diagonal() << second, first + Vector2d::Constant(0.09);
  P(0, 2) = P(2, 0) = first.x();
  P(1, 3) = P(3, 1) = first.y();
  MatrixXd H(2, 4);
  H << -1, 0, 1, 0, 0, -1, 0, 1;
  const MatrixXd S = H * P * H.transpose() + 0.09 * MatrixXd::Identity(2, 2),
                 K = P * H.transpose() * S.inverse();
  const Vector2d innovation = Vector2d(1.2, 1.1) - H * x;
  x += K * innovation;
  P -= K * S * K.transpose();

  const VectorXd found = values(filter);
  const Indices which{0, 1, 3, 4};  // without the heading
  EXPECT_LT((picked(found, which, {0}) - x).norm(), 1e-6);
  const MatrixXd covariance = filter.covariance();
  EXPECT_LT((picked(covariance, which, which) - P).norm(), 1e-6);
  EXPECT_NEAR(filter.nis(), innovation.dot(S.inverse() * innovation), 1e-6);
  EXPECT_EQ(filter.nisDof(), 2);
}

// Draws robots and observations; the landmarks scatter with the covariance.
TEST(LandmarkFilter, ANewLandmarkIsCorrelatedWithTheRobot) {
  const Pose2 robot{{3, -1}, 0.8};
  Matrix3d start = Vector3d(0.01, 0.02, 0.0004).asDiagonal();
  start(0, 2) = start(2, 0) = 0.001;
  LandmarkFilter filter({}, robot, start);
  const Observation2D z = observation({4, 1}, 0.05, 0.3);
  filter.add(z);

  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 1);
  const auto drawn = [&](const Matrix3d& covariance) {
    return Vector3d(covariance.llt().matrixL() * Vector3d{noise(random), noise(random), noise(random)});
  };
  const int count = 100000;
  MatrixXd errors(6, count);
  for (int i = 0; i < count; ++i) {
    const Vector3d e = drawn(start), v = drawn(z.covariance);
    const Pose2 truth{robot.position + e.head<2>(), robot.heading + e(2)};
    const Vector2d landmark = truth * Vector2d(z.position + v.head<2>());
    errors.col(i) << e, landmark - filter.landmarks()[0].position,
        wrapped(truth.heading + *z.heading + v(2) - *filter.landmarks()[0].heading);
  }
  const MatrixXd scatter = errors * errors.transpose() / count;
  EXPECT_LT((filter.covariance() - scatter).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(LandmarkFilter, StaysPositiveDefinite) {
  LandmarkFilter filter({}, {}, 1e-12 * Matrix3d::Identity());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-5, 5);
  for (int k = 0; k < 5; ++k) filter.add(observation({anywhere(random), anywhere(random)}, 100.0));
  for (int i = 0; i < 2000; ++i) {
    filter.predict(step(0.1, 0, 0.3, i % 100 ? 1e-6 : 1.0));
    const size_t k = i % 5;
    filter.update(
        {{k, observation(filter.pose().inverse() * filter.landmarks()[k].position, i % 7 ? 1e-5 : 10.0)}});
  }
  const VectorXd variances = filter.covariance().selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_GT(variances.minCoeff(), -1e-9);
  EXPECT_TRUE(values(filter).allFinite());
}

TEST(LandmarkFilter, RemovingALandmarkKeepsTheOthers) {
  LandmarkFilter filter = driven();
  const VectorXd before = values(filter);
  const MatrixXd covariance = filter.covariance();
  filter.remove(0);
  const Indices left{0, 1, 2, 5, 6, 7, 8, 9};
  EXPECT_LT((values(filter) - picked(before, left, {0})).norm(), 1e-12);
  EXPECT_LT((filter.covariance() - picked(covariance, left, left)).norm(), 1e-12);
}

// Merged landmarks are at their weighted mean, with its covariance.
TEST(LandmarkFilter, MergedLandmarksAreTheirWeightedMean) {
  LandmarkFilter filter({}, {}, 1e-12 * Matrix3d::Identity());
  filter.add(observation({2, 0}, 0.1));
  filter.add(observation({2.3, 0}, 0.2));
  filter.merge(0, 1);
  ASSERT_EQ(filter.landmarks().size(), 1u);
  EXPECT_LT((filter.landmarks()[0].position - Vector2d(2.06, 0)).norm(), 1e-5);
  EXPECT_LT((filter.covariance().bottomRightCorner(2, 2) - 0.008 * MatrixXd::Identity(2, 2)).norm(), 1e-5);
}

TEST(LandmarkFilter, AStateIsReturnedAsItWasSet) {
  const LandmarkFilter filter = driven();
  LandmarkFilter other({}, {}, kStart);
  other.setState(filter.pose(), filter.landmarks(), filter.covariance());
  EXPECT_LT((values(other) - values(filter)).norm(), 1e-12);
  EXPECT_LT((other.covariance() - filter.covariance()).norm(), 1e-9);
  EXPECT_THROW(other.setState({}, filter.landmarks(), kStart), std::invalid_argument);
}

TEST(LandmarkFilter, SettingThePoseKeepsTheLandmarks) {
  LandmarkFilter filter = driven();
  const MatrixXd before = filter.covariance();
  const Pose2 elsewhere{{-4, 5}, 3.0};
  filter.setPose(elsewhere, kStart);
  const MatrixXd after = filter.covariance();
  EXPECT_LT((values(filter).head<3>() - Vector3d(-4, 5, 3.0)).norm(), 1e-12);
  EXPECT_LT((after.topLeftCorner<3, 3>() - kStart).norm(), 1e-9);
  EXPECT_LT(after.bottomLeftCorner(7, 3).norm(), 1e-9);
  EXPECT_LT((after.bottomRightCorner(7, 7) - before.bottomRightCorner(7, 7)).norm(), 1e-9);
}

TEST(LandmarkFilter, PredictPoseEqualsPredict) {
  LandmarkFilter filter = driven();
  const OdometryStep small = step(0.05, 0.01, 0.02, 1e-3);
  const PoseEstimate2D ahead = filter.predictPose(small);
  filter.predict(small);
  EXPECT_LT((ahead.pose.position - filter.pose().position).norm(), 1e-3);
  EXPECT_LT((ahead.covariance - filter.covariance({})).norm(), 1e-2 * ahead.covariance.norm());
}

/// A filter that observed a landmark while the robot drove on an arc.
/// @param truth, measured motion in each step
LandmarkFilter afterArc(const LandmarkFilterParams& params, const Pose2& truth, const Pose2& measured) {
  LandmarkFilter filter(params, {}, 1e-8 * Matrix3d::Identity());
  Pose2 robot;
  const Vector2d landmark(3, 1);
  filter.add(observation(landmark, 0.01));
  for (int i = 0; i < 100; ++i) {
    robot = robot * truth;
    filter.predict(step(measured.position.x(), 0, measured.heading, 1e-3));
    filter.update({{0, observation(robot.inverse() * landmark, 0.01)}});
  }
  return filter;
}

TEST(LandmarkFilter, EstimatesTheScaleOfOdometry) {
  LandmarkFilterParams scaled;
  scaled.scale_sigma = 0.1;
  const LandmarkFilter filter = afterArc(scaled, {{0.09, 0}, 0.1}, {{0.1, 0}, 0.1});
  EXPECT_NEAR(filter.scale(), 0.9, 0.01);
  EXPECT_LT(std::abs(filter.scale() - 0.9), 3 * std::sqrt(filter.scaleVariance()));
  EXPECT_EQ(filter.turnScaleVariance(), 0);
}

TEST(LandmarkFilter, EstimatesTheScaleOfTurns) {
  LandmarkFilterParams scaled;
  scaled.turn_scale_sigma = 0.2;
  const LandmarkFilter filter = afterArc(scaled, {{0.05, 0}, 0.1}, {{0.05, 0}, 0.11});
  EXPECT_NEAR(filter.turnScale(), 1 / 1.1, 0.01);
  EXPECT_LT(std::abs(filter.turnScale() - 1 / 1.1), 3 * std::sqrt(filter.turnScaleVariance()));
  EXPECT_EQ(filter.scaleVariance(), 0);
}

// The truth: the sensor is turned by -0.05. A robot that drives straight ahead past landmarks observes it.
TEST(LandmarkFilter, EstimatesTheErrorOfTheMount) {
  LandmarkFilterParams mounted;
  mounted.bearing_sigma = 0.1;
  LandmarkFilter filter(mounted, {}, 1e-8 * Matrix3d::Identity());
  const std::vector<Vector2d> landmarks{{3, 1}, {5, -2}, {8, 1}};
  Pose2 robot;
  const auto observed = [&](const Vector2d& landmark) {
    // As LandmarkSlam does, the estimate so far is added to the bearing.
    return observation(Pose2{{0, 0}, filter.bearing() - 0.05} * (robot.inverse() * landmark), 0.01);
  };
  for (const Vector2d& landmark : landmarks) filter.add(observed(landmark));
  for (int i = 0; i < 60; ++i) {
    robot = robot * Pose2{{0.1, 0}, 0};
    filter.predict(step(0.1, 0, 0, 1e-4));
    std::vector<AssociatedObservation> seen;
    for (size_t k = 0; k < landmarks.size(); ++k) seen.push_back({k, observed(landmarks[k])});
    filter.update(seen);
  }
  EXPECT_NEAR(filter.bearing(), 0.05, 0.005);
  EXPECT_LT(std::abs(filter.bearing() - 0.05), 3 * std::sqrt(filter.bearingVariance()));
  for (size_t k = 0; k < landmarks.size(); ++k)
    EXPECT_LT((filter.landmarks()[k].position - landmarks[k]).norm(), 0.05) << k;
}

TEST(LandmarkFilter, EstimatesTheClockOffset) {
  LandmarkFilterParams clocked;
  clocked.clock_sigma = 0.2;
  LandmarkFilter filter(clocked, {}, 1e-8 * Matrix3d::Identity());
  Pose2 robot;
  const Vector2d landmark(3, 1);
  filter.add(observation(landmark, 0.005));
  for (int i = 0; i < 200; ++i) {
    const double turn =
        i % 40 < 20 ? 0.1 : -0.1;  // in 0.1 s; seen 0.05 s after the stamp, that is corrected so far
    const double late = (0.05 - filter.clockOffset()) / 0.1;
    robot = robot * Pose2{{0.05, 0}, turn};
    filter.predict(step(0.05, 0, turn, 1e-4), 0.1);
    const Pose2 then = robot * Pose2{{0.05 * late, 0}, turn * late};
    filter.update({{0, observation(then.inverse() * landmark, 0.005)}});
  }
  EXPECT_NEAR(filter.clockOffset(), 0.05, 0.01);
}

TEST(LandmarkFilter, RefusesALandmarkThatIsObservedTwiceInOneScan) {
  LandmarkFilter filter = driven();
  EXPECT_THROW(filter.update({{0, observation({1, 0})}, {0, observation({1, 0})}}), std::invalid_argument);
}

TEST(LandmarkFilter, RefusesInvalidCovariances) {
  EXPECT_THROW(LandmarkFilter({}, {}, -kStart), std::invalid_argument);
}

/// Much is learned at once: a robot that hardly knows its heading sees what it knows exactly, aside far
/// better than in range, so that the covariance of an observation turns with the heading.
TEST(LandmarkFilter, LargeUpdatesAreConsistent) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const std::vector<Landmark2D> landmarks{{{4, 1}, {}}, {{4, -1.5}, {}}};
  const Matrix3d start = Vector3d(0.5, 0.5, 0.25).cwiseAbs2().asDiagonal();
  double nees = 0;
  const int runs = 400;
  for (int run = 0; run < runs; ++run) {
    const Pose2 truth{{0.5 * normal(random), 0.5 * normal(random)}, 0.25 * normal(random)};
    LandmarkFilter filter({}, {}, start);
    MatrixXd covariance = 1e-8 * MatrixXd::Identity(7, 7);
    covariance.topLeftCorner<3, 3>() = start;
    filter.setState({}, landmarks, covariance);
    std::vector<AssociatedObservation> seen;
    for (size_t k = 0; k < landmarks.size(); ++k) {
      const Vector2d z = truth.inverse() * landmarks[k].position;
      const Eigen::Matrix2d axes = rotation2(std::atan2(z.y(), z.x()));
      const Vector2d sigmas(0.08, 0.01);
      Observation2D observation{
          z + axes * sigmas.cwiseProduct(Vector2d{normal(random), normal(random)}), {}, Matrix3d::Zero()};
      observation.covariance.topLeftCorner<2, 2>() =
          axes * sigmas.cwiseAbs2().asDiagonal() * axes.transpose();
      seen.push_back({k, observation});
    }
    filter.update(seen);
    Vector3d error;
    error << truth.position - filter.pose().position, wrapped(truth.heading - filter.pose().heading);
    nees += error.dot(filter.covariance({}).ldlt().solve(error)) / (3 * runs);
  }
  EXPECT_GT(nees, 0.8);
  EXPECT_LT(nees, 1.35);
}

}  // namespace
}  // namespace sextant
