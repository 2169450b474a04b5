// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/landmark_adjustment.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace sextant {
namespace {

const Eigen::Matrix3d kStart = Eigen::Vector3d(1e-4, 4e-4, 9e-6).asDiagonal();

Observation2D seenFrom(const Pose2& T_map_base, const Landmark2D& landmark) {
  const Landmark2D seen = toRobotFrame(T_map_base, landmark);
  Observation2D observation{seen.position, seen.heading, Eigen::Matrix3d::Zero()};
  observation.covariance.diagonal() << 0.01, 0.02, 0.005;
  return observation;
}

OdometryStep stepBetween(const Pose2& from, const Pose2& to) {
  const Pose2 step = from.inverse() * to;
  OdometryStep odometry{step, Eigen::Matrix3d::Zero(), step.position.norm(), step.heading};
  odometry.noise.diagonal() << 0.01, 0.003, 0.002;
  return odometry;
}

// A robot on a circle around three landmarks, the second of which has a heading.
struct Circle {
  Circle() {
    for (int k = 0; k < 20; ++k) {
      const double angle = 0.4 * k;
      poses.push_back({{3 * std::sin(angle), 3 - 3 * std::cos(angle)}, wrapped(angle)});
    }
    for (size_t k = 0; k + 1 < poses.size(); ++k)
      measured.steps.push_back({k, stepBetween(poses[k], poses[k + 1]), false});
    for (size_t k = 0; k < poses.size(); ++k)
      for (size_t i = 0; i < landmarks.size(); ++i)
        measured.sightings.push_back({k, i, seenFrom(poses[k], landmarks[i]), {}});
    measured.first_pose = poses.front();
    measured.covariance_of_known = kStart;
  }

  AdjustedLandmarks roughly() const {
    AdjustedLandmarks begin{poses, landmarks, 1, 1, 0, {}};
    for (size_t k = 1; k < poses.size(); ++k) {
      begin.poses[k].position += Eigen::Vector2d(0.3, -0.2);
      begin.poses[k].heading += 0.1;
    }
    for (Landmark2D& each : begin.landmarks) each.position += Eigen::Vector2d(-0.4, 0.3);
    return begin;
  }

  std::vector<Pose2> poses;
  std::vector<Landmark2D> landmarks{{{1, 2}, {}}, {{-1, 3}, 2.9}, {{0.5, 4}, {}}};
  LandmarkDrives measured;
};

void expectNear(const AdjustedLandmarks& found, const Circle& truth, double tolerance) {
  for (size_t k = 0; k < truth.poses.size(); ++k) {
    EXPECT_LT((found.poses[k].position - truth.poses[k].position).norm(), tolerance);
    EXPECT_LT(std::abs(wrapped(found.poses[k].heading - truth.poses[k].heading)), tolerance);
  }
  for (size_t i = 0; i < truth.landmarks.size(); ++i)
    EXPECT_LT((found.landmarks[i].position - truth.landmarks[i].position).norm(), tolerance);
  EXPECT_NEAR(wrapped(*found.landmarks[1].heading - *truth.landmarks[1].heading), 0, tolerance);
}

TEST(LandmarkAdjustment, ExactMeasurementsGiveTheExactDrive) {
  const Circle circle;
  const AdjustedLandmarks found = adjustLandmarks(circle.measured, {}, circle.roughly());
  expectNear(found, circle, 1e-5);
}

TEST(LandmarkAdjustment, OneGrossErrorMovesTheMapLittle) {
  Circle circle;
  circle.measured.sightings[7].observation.position += Eigen::Vector2d(3, 0);
  const AdjustedLandmarks found = adjustLandmarks(circle.measured, {}, circle.roughly());
  expectNear(found, circle, 0.05);
}

TEST(LandmarkAdjustment, ARobotThatIsCarriedAwayLeavesTheMapAsItIs) {
  Circle circle;
  for (size_t k = 10; k < circle.poses.size(); ++k) circle.poses[k] = Pose2{{1, 2}, 1.5} * circle.poses[k];
  for (LandmarkDrives::Sighting& each : circle.measured.sightings)
    each.observation = seenFrom(circle.poses[each.pose], circle.landmarks[each.landmark]);
  for (LandmarkDrives::Step& each : circle.measured.steps) each.odometry.noise /= 100;
  for (size_t k = 7; k < 12; ++k) circle.measured.steps[k].may_slip = true;
  AdjustedLandmarks begin = circle.roughly();
  begin.poses = circle.poses;  // the filter has found the robot again
  expectNear(adjustLandmarks(circle.measured, {}, begin), circle, 0.03);
}

TEST(LandmarkAdjustment, EstimatesTheErrorsOfOdometryAndMount) {
  Circle circle;
  for (LandmarkDrives::Step& each : circle.measured.steps) {
    each.odometry.step.position /= 1.1;
    each.odometry.step.heading /= 0.9;
    each.odometry.turn /= 0.9;
    each.odometry.noise /= 25;
  }
  const Pose2 mount{{0.2, 0.1}, 0.5};
  for (LandmarkDrives::Sighting& each : circle.measured.sightings) {
    each.T_base_sensor = mount;
    each.observation = mount * (Pose2{{0, 0}, -0.02} * (mount.inverse() * each.observation));
    each.observation.covariance /= 1e4;
  }
  LandmarkFilterParams params;
  params.scale_sigma = params.turn_scale_sigma = 0.3;
  params.bearing_sigma = 0.1;
  const AdjustedLandmarks found = adjustLandmarks(circle.measured, params, circle.roughly());
  expectNear(found, circle, 0.01);
  EXPECT_NEAR(found.scale, 1.1, 0.005);
  EXPECT_NEAR(found.turn_scale, 0.9, 0.005);
  EXPECT_NEAR(found.bearing, 0.02, 0.003);
}

// One landmark from one pose: P_landmark = J P_pose J^T + R R_observation R^T.
TEST(LandmarkAdjustment, TheCovarianceIsThatOfTheSingleObservation) {
  const Pose2 pose{{1, -1}, 0.7};
  const Landmark2D landmark{{3, 1}, {}};
  LandmarkDrives measured;
  measured.sightings.push_back({0, 0, seenFrom(pose, landmark), {}});
  measured.first_pose = pose;
  measured.covariance_of_known = kStart;
  const AdjustedLandmarks found = adjustLandmarks(measured, {}, {{pose}, {landmark}, 1, 1, 0, {}});
  Eigen::Matrix<double, 2, 3> J;
  J << Eigen::Matrix2d::Identity(), perpendicular(landmark.position - pose.position);
  const Eigen::Matrix2d R = rotation2(pose.heading);
  const Eigen::Matrix2d noise = measured.sightings[0].observation.covariance.topLeftCorner<2, 2>();
  const Eigen::Matrix2d expected = J * kStart * J.transpose() + R * noise * R.transpose();
  ASSERT_EQ(found.covariance.rows(), 5);
  EXPECT_TRUE((found.covariance.bottomRightCorner<2, 2>()).isApprox(expected, 1e-6));
  EXPECT_TRUE((found.covariance.topLeftCorner<3, 3>()).isApprox(kStart, 1e-6));
}

// A landmark that was known before is seen once from an unknown pose beside a second one.
TEST(LandmarkAdjustment, AKnownMapStays) {
  Circle circle;
  circle.measured.first_pose.reset();
  circle.measured.known = circle.landmarks;
  circle.measured.covariance_of_known = 1e-4 * Eigen::MatrixXd::Identity(7, 7);
  const AdjustedLandmarks found = adjustLandmarks(circle.measured, {}, circle.roughly());
  expectNear(found, circle, 1e-5);
  EXPECT_LT(found.covariance.diagonal().tail(7).maxCoeff(), 1e-4);
}

TEST(LandmarkAdjustment, RefusesWhatIsNotDetermined) {
  Circle circle;
  circle.measured.steps.pop_back();
  circle.measured.sightings.resize(circle.measured.sightings.size() - 3);
  EXPECT_THROW(adjustLandmarks(circle.measured, {}, circle.roughly()), std::runtime_error);
}

}  // namespace
}  // namespace sextant
