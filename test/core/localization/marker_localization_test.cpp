// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_localization.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "test_cameras.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

MarkerMap oneMarker() {
  MarkerMap map;
  map.add({{kFamily, 0}, 0.2, "", poseFromXyzRpy({3, 0, 1}, {M_PI_2, 0, -M_PI_2}), Matrix6d::Zero()});
  return map;
}

// A robot that drives from 1 m to 5 m away from one marker, facing it with a little wobble, must stay on the
// planar solution of the start.
TEST(MarkerLocalization, OdometryKeepsToTheTrueBranch) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerLocalization localization{LocalizationParams{}};
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 1);
  const Pose T_map_odom = poseFromXyzRpy({0.4, -0.2, 0}, {0, 0, 0.3});
  int published = 0, outside = 0;
  double largest_turn = 0;
  for (int i = 0; i < 300; ++i) {
    const double way = 1.0 + 4.0 * i / 300, wobble = 0.15 * std::sin(0.1 * i);
    const Pose T_map_base = poseFromXyzRpy({3 - way, wobble, 0}, {0, 0, -wobble / way});
    const auto result = localization.locate(oneMarker(), {look(oneMarker(), camera, T_map_base, 0.3, i)},
                                            T_map_odom.inverse() * T_map_base);
    if (!result.pose) continue;
    ++published;
    const Vector6d error = poseError(T_map_base, result.pose->T_map_base);
    const double region99 = 16.81;  // chi-square, 6 degrees of freedom
    outside += error.dot(result.pose->covariance.inverse() * error) > region99;
    largest_turn = std::max(largest_turn, error.tail<3>().norm());
  }
  EXPECT_GE(published, 295);
  EXPECT_LE(outside, 9);
  EXPECT_LT(largest_turn, 0.8);  // the other branch would be up to 1.2 rad away
  const Pose error = T_map_odom.inverse() * *localization.correction().transform();
  EXPECT_LT(error.translation().norm(), 0.5);
}

TEST(MarkerLocalization, AFalseMarkerAgainstOdometryIsNoPose) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerLocalization localization{LocalizationParams{}};
  for (int i = 0; i < 5; ++i)
    ASSERT_TRUE(localization.locate(room(), {look(room(), camera, kTruth, 0.3, i)}, Pose::Identity()).pose);
  MarkerView wrong = look(room(), camera, kTruth, 0.3, 9);
  wrong.detections = {wrong.detections[3]};
  wrong.detections[0].key.id = 0;  // read wrongly
  const auto result = localization.locate(room(), {wrong}, Pose::Identity());
  EXPECT_FALSE(result.pose);
  EXPECT_EQ(result.reason, "the markers contradict the odometry");
  EXPECT_TRUE(localization.locate(room(), {look(room(), camera, kTruth, 0.3, 10)}, Pose::Identity()).pose);
}

TEST(MarkerLocalization, RecoversWhereTheOdometryWasWrong) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  LocalizationParams params;
  MarkerLocalization localization(params);
  localization.locate(room(), {look(room(), camera, kTruth, 0.3, 1)}, Pose::Identity());
  const Pose carried =
      kTruth * poseFromXyzRpy({-0.5, 0.4, 0}, {0, 0, 0.1});  // lifted: the wheels did not turn
  int refused = 0;
  while (
      refused < 100 &&
      !localization.locate(room(), {look(room(), camera, carried, 0.3, 2 + refused)}, Pose::Identity()).pose)
    ++refused;
  EXPECT_EQ(refused, params.odometry.max_rejections - 1);
  EXPECT_LT(poseError(carried, *localization.correction().transform()).norm(), 0.1);
}

TEST(MarkerLocalization, CovarianceFollowsTheNoiseThatTheCameraHas) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  LocalizationParams params;
  const auto deviation = [&](bool estimate) {
    params.estimate_noise = estimate;
    MarkerLocalization localization(params);
    LocatorResult last;
    for (int i = 0; i < 60; ++i)
      last = localization.locate(room(), {look(room(), camera, kTruth, 0.06, i)}, {});
    return std::sqrt(last.pose->covariance(0, 0));
  };
  EXPECT_NEAR(deviation(true) / deviation(false), 0.06 / 0.3, 0.04);
}

TEST(MarkerLocalization, ForgetsOnDemand) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerLocalization localization{LocalizationParams{}};
  localization.locate(room(), {look(room(), camera, kTruth, 0.3, 1)}, Pose::Identity());
  EXPECT_TRUE(localization.correction().transform());
  localization.reset();
  EXPECT_FALSE(localization.correction().transform());
}

TEST(MarkerLocalization, RefusedParametersChangeNothing) {
  MarkerLocalization localization{LocalizationParams{}};
  LocalizationParams params;
  params.locator.corner_sigma = 0.5;
  params.odometry.max_rejections = -1;
  EXPECT_THROW(localization.setParams(params), std::invalid_argument);
  EXPECT_EQ(localization.params().locator.corner_sigma, LocatorParams{}.corner_sigma);
}

}  // namespace
}  // namespace sextant
