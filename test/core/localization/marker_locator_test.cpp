// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_locator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "test_cameras.hpp"
#include "test_refusal.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

LocatorParams mode(const std::string& name) {
  LocatorParams params;
  params.mode = name;
  return params;
}

TEST(MarkerLocator, ExactCornersGiveTheExactPoseInEveryMode) {
  for (const auto& calibration : testCalibrations()) {
    const CameraModel camera(calibration, CameraModel::Image::raw);
    for (const auto& name : locatorModes()) {
      const auto result = MarkerLocator(mode(name)).locate(room(), {look(room(), camera, kTruth, 0, 1)});
      ASSERT_TRUE(result.pose) << result.reason;
      EXPECT_LT(poseError(kTruth, result.pose->T_map_base).norm(), 1e-5) << name;
      EXPECT_EQ(result.pose->used().size(), name == "nearest" ? 1u : 4u);
    }
  }
}

TEST(MarkerLocator, NearestTakesTheSmallestDepth) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const auto result = MarkerLocator(mode("nearest")).locate(room(), {look(room(), camera, kTruth, 0, 1)});
  // Marker 0 is 1.75 m ahead, marker 3 closer by the straight line but 1.89 m ahead.
  EXPECT_EQ(result.pose->used()[0], (MarkerKey{kFamily, 0}));
}

// A map whose markers are 3 cm off, up and down in turn: residuals of several pixels.
TEST(MarkerLocator, DeclaredErrorsOfTheMapAreNoReasonToRefuseAPose) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const MarkerMap exact = room();
  for (const double sigma : {0.0, 0.03}) {
    MarkerMap wrong;
    for (auto [key, marker] : exact.markers()) {
      marker.T_map_marker.translation().z() += key.id % 2 == 0 ? 0.03 : -0.03;
      marker.covariance.diagonal().head<3>().setConstant(sigma * sigma);
      wrong.add(marker);
    }
    LocatorParams params;
    params.gate = 1e6;
    const auto result = MarkerLocator(params).locate(wrong, {look(exact, camera, kTruth, 0.1, 1)});
    EXPECT_EQ(result.pose.has_value(), sigma > 0);
    EXPECT_EQ(result.rejected.has_value(), sigma == 0);
  }
}

TEST(MarkerLocator, JointIsConsistentAndBetterThanAverage) {
  const CameraModel camera(testCalibrations()[1], CameraModel::Image::raw);
  LocatorParams params = mode("joint");
  params.corner_sigma = 0.3;
  const MarkerLocator joint(params), average(mode("average"));
  const int n = 300;
  double nees = 0, joint_squares = 0, average_squares = 0;
  for (int i = 0; i < n; ++i) {
    const MarkerView view = look(room(), camera, kTruth, params.corner_sigma, 100 + i);
    const auto a = joint.locate(room(), {view}), b = average.locate(room(), {view});
    ASSERT_TRUE(a.pose && b.pose);
    const Vector6d error = poseError(kTruth, a.pose->T_map_base);
    nees += error.dot(a.pose->covariance.inverse() * error) / n;
    joint_squares += error.head<3>().squaredNorm();
    average_squares += poseError(kTruth, b.pose->T_map_base).head<3>().squaredNorm();
  }
  EXPECT_NEAR(nees, 6.0, 0.7);  // chi-square, 6 degrees of freedom: sqrt(12 / 300) = 0.2 a deviation
  EXPECT_LT(joint_squares, 0.25 * average_squares);
}

TEST(MarkerLocator, JointSurvivesOneFalseMarker) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerView view = look(room(), camera, kTruth, 0.1, 7);
  for (auto& corner : view.detections[1].corners) corner += Eigen::Vector2d(4, -3);
  const auto result = MarkerLocator(mode("joint")).locate(room(), {view});
  ASSERT_TRUE(result.pose) << result.reason;
  EXPECT_LT(poseError(kTruth, result.pose->T_map_base).head<3>().norm(), 0.02);
}

TEST(MarkerLocator, TwoCamerasAreOneProblem) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerView left = look(room(), camera, kTruth, 0, 1), right = left;
  left.detections.resize(2);
  right.detections.erase(right.detections.begin(), right.detections.begin() + 2);
  const auto result = MarkerLocator(mode("joint")).locate(room(), {left, right});
  ASSERT_TRUE(result.pose);
  EXPECT_EQ(result.pose->used().size(), 4u);
  EXPECT_LT(poseError(kTruth, result.pose->T_map_base).norm(), 1e-6);
}

TEST(MarkerLocator, TwoMarkersThatContradictEachOtherAreNotCertain) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerView swapped = look(room(), camera, kTruth, 0.1, 1);
  std::swap(swapped.detections[0].key, swapped.detections[3].key);
  swapped.detections = {swapped.detections[0], swapped.detections[3]};
  LocatorParams params = mode("joint");
  params.corner_sigma = 0.1;
  const auto open = MarkerLocator(params).locate(room(), {swapped});
  ASSERT_TRUE(open.pose) << open.reason;
  EXPECT_LT(open.pose->probability, params.min_probability);
  EXPECT_EQ(open.pose->used().size(), 1u);
  EXPECT_EQ(open.pose->outliers().size(), 1u);
  params.ambiguous_pose = "skip";
  const auto skipped = MarkerLocator(params).locate(room(), {swapped});
  EXPECT_FALSE(skipped.pose);
  EXPECT_NE(skipped.reason.find("ambiguous"), std::string::npos);
}

// Two corners give four equations for six unknowns; the floor gives three more.
TEST(MarkerLocator, AMarkerOfWhichTwoCornersAreHiddenTellsNoPoseAlone) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerView view = look(room(), camera, kTruth, 0.1, 7);
  view.detections[0].corner_sigmas = {0.1, 6, 6, 0.1};
  LocatorParams params = mode("joint");
  EXPECT_TRUE(MarkerLocator(params).locate(room(), {view}).pose);
  view.detections.resize(1);
  const auto alone = MarkerLocator(params).locate(room(), {view});
  EXPECT_FALSE(alone.pose);
  EXPECT_NE(alone.reason.find("corners"), std::string::npos) << alone.reason;
  params.floor_height_sigma = 0.01;
  const auto on_floor = MarkerLocator(params).locate(room(), {view});
  ASSERT_TRUE(on_floor.pose) << on_floor.reason;
  EXPECT_LT(poseError(kTruth, on_floor.pose->T_map_base).head<3>().norm(), 0.1);
}

TEST(MarkerLocator, FloorHoldsTheRobotDown) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const Pose truth = poseFromXyzRpy({0.7, 0.3, 0}, {0, 0, 0.35});
  MarkerView view = look(room(), camera, truth, 0.3, 3);
  view.detections.resize(1);
  LocatorParams params = mode("joint");
  const auto free = MarkerLocator(params).locate(room(), {view});
  params.floor_height_sigma = params.floor_tilt_sigma = 1e-3;
  const auto held = MarkerLocator(params).locate(room(), {view});
  ASSERT_TRUE(free.pose && held.pose);
  EXPECT_GT(std::sqrt(free.pose->covariance(2, 2)), 0.02);
  EXPECT_LT(std::sqrt(held.pose->covariance(2, 2)), 1.1e-3);
  EXPECT_LT(std::abs(held.pose->T_map_base.translation().z()), 4e-3);
}

TEST(MarkerLocator, AnUncertainMapMakesAnUncertainPose) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerMap taped;
  const MarkerMap exact_map = room();
  for (auto [key, marker] : exact_map.markers()) {
    marker.covariance.diagonal() << 4e-4, 4e-4, 4e-4, 1e-8, 1e-8, 1e-8;
    taped.add(marker);
  }
  const MarkerView view = look(room(), camera, kTruth, 0.1, 3);
  LocatorParams params = mode("joint");
  params.corner_sigma = 0.1;
  const MarkerLocator locator(params);
  const auto exact = locator.locate(room(), {view}), loose = locator.locate(taped, {view});
  ASSERT_TRUE(exact.pose && loose.pose);
  // Four markers with 2 cm each: at least 1 cm, if all have the same influence.
  EXPECT_LT(std::sqrt(exact.pose->covariance(2, 2)), 0.005);
  EXPECT_GT(std::sqrt(loose.pose->covariance(2, 2)), 0.0099);
}

TEST(MarkerLocator, ConstantCovarianceIsToldAsItIs) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  LocatorParams params = mode("joint");
  params.constant_covariance.assign(36, 0.0);
  for (int i = 0; i < 6; ++i) params.constant_covariance[7 * i] = 0.1 * (i + 1);
  params.constant_covariance[1] = params.constant_covariance[6] = 0.05;
  const auto result = MarkerLocator(params).locate(room(), {look(room(), camera, kTruth, 0.1, 3)});
  ASSERT_TRUE(result.pose);
  EXPECT_EQ(result.pose->covariance(0, 1), 0.05);
  EXPECT_DOUBLE_EQ(result.pose->covariance(5, 5), 0.6);
  params.constant_covariance[1] = 0.04;
  EXPECT_THROW(MarkerLocator{params}, std::invalid_argument);
  params.constant_covariance.resize(6);
  EXPECT_THROW(MarkerLocator{params}, std::invalid_argument);
}

TEST(MarkerLocator, SaysWhyThereIsNoPose) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const MarkerLocator locator(mode("joint"));
  const MarkerView good = look(room(), camera, kTruth, 0, 1);
  const auto reason = [&](const MarkerView& view) {
    const auto result = locator.locate(room(), {view});
    EXPECT_FALSE(result.pose);
    return result.reason;
  };
  MarkerView none = good, stranger = good, twice = good, wrong = good;
  none.detections.clear();
  EXPECT_EQ(reason(none), "no marker in sight");
  stranger.detections.resize(1);
  stranger.detections[0].key.id = 77;
  EXPECT_EQ(reason(stranger), "no marker in sight is in the map");
  twice.detections = {good.detections[0], good.detections[0]};
  EXPECT_EQ(reason(twice),
            "the mapped markers in sight were detected more than once, or their corners give no pose");
  wrong.detections.resize(1);
  wrong.detections[0].corners[0] += Eigen::Vector2d(-12, -9);  // no square's
  EXPECT_NE(reason(wrong).find("no pose fits any marker"), std::string::npos);
  EXPECT_EQ(locator.locate(room(), {}).reason, "no marker in sight");
}

TEST(LocatorParams, RefusesWhatIsOutOfRange) {
  EXPECT_THROW(MarkerLocator(mode("best")), std::invalid_argument);
  LocatorParams params;
  params.corner_sigma = 0;
  EXPECT_THROW(MarkerLocator{params}, std::invalid_argument);
  params = {};
  params.robust_width = std::nan("");
  EXPECT_THROW(MarkerLocator{params}, std::invalid_argument);
  params = {};
  params.min_probability = 0.9999999;
  MarkerLocator{params};
  params.min_probability = 0.99999999;
  EXPECT_EQ(refusal<std::invalid_argument>([&] { MarkerLocator{params}; }),
            "min_probability is 1, allowed is [0.5, 0.9999999]");
}

}  // namespace
}  // namespace sextant
