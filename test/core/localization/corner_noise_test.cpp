// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/corner_noise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "test_cameras.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

// The scale after a number of images of two cameras with this corner noise; 0.3 pixels are assumed.
CornerNoise after(int images, double left_sigma, double right_sigma) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const MarkerLocator locator{LocatorParams{}};
  CornerNoise noise;
  for (int i = 0; i < images; ++i) {
    MarkerView left = look(room(), camera, kTruth, left_sigma, 2 * i),
               right = look(room(), camera, kTruth, right_sigma, 2 * i + 1);
    right.camera_index = 1;
    left.noise_scale = noise.scale(0);
    right.noise_scale = noise.scale(1);
    const auto result = locator.locate(room(), {left, right});
    if (result.pose) noise.add(*result.pose);
  }
  return noise;
}

TEST(CornerNoise, SaysNothingBeforeItHasSeenEnough) {
  const CornerNoise noise = after(3, 0.1, 0.1);
  EXPECT_EQ(noise.scale(0), 1.0);
  EXPECT_EQ(noise.scale(7), 1.0);
}

TEST(CornerNoise, FindsTheNoiseOfEachCamera) {
  const CornerNoise noise = after(150, 0.1, 0.4);
  EXPECT_NEAR(0.3 * noise.typical(0), 0.1, 0.01);
  EXPECT_NEAR(0.3 * noise.typical(1), 0.4, 0.03);
}

// The corners of one marker have additional noise, given by their corner_sigmas.
TEST(CornerNoise, FindsWhatAllCornersHaveInCommon) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const MarkerLocator locator{LocatorParams{}};
  std::mt19937 random(5);
  std::normal_distribution<double> own(0, 0.5);
  CornerNoise noise;
  for (int i = 0; i < 400; ++i) {
    MarkerView view = look(room(), camera, kTruth, 0.1, i);
    view.detections[1].corner_sigmas.fill(0.5);
    for (auto& corner : view.detections[1].corners) corner += Eigen::Vector2d{own(random), own(random)};
    view.noise_scale = noise.scale(0);
    const auto result = locator.locate(room(), {view});
    ASSERT_TRUE(result.pose) << result.reason;
    noise.add(*result.pose);
  }
  EXPECT_NEAR(0.3 * noise.typical(0), 0.1, 0.01);
}

// If images do not differ, the noise estimate of a single one has little weight.
TEST(CornerNoise, OneImageOfManyAlikeIsLikeTheOthers) {
  const CornerNoise noise = after(150, 0.3, 0.3);
  EXPECT_NEAR(noise.scale(0) / noise.typical(0), 1.0, 0.1);
  EXPECT_NEAR(noise.scale(0, {{2.0 * 13, 13}, {}}) / noise.typical(0), 1.0, 0.1);
}

// Noise of images that differ: variances 6 / chi-square(6), so that one error follows Student's t.
TEST(CornerNoise, ImagesThatDifferAreToldApart) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const MarkerLocator locator{LocatorParams{}};
  std::mt19937 random(3);
  std::chi_squared_distribution<double> chi_squared(6);
  CornerNoise noise;
  int images = 0, far = 0, lone_far = 0;
  for (int i = 0; i < 1200; ++i) {
    const double sigma = 0.2 * std::sqrt(6 / chi_squared(random));
    MarkerView view = look(room(), camera, kTruth, sigma, i);
    view.noise_scale = noise.scale(0);
    auto result = locator.locate(room(), {view});
    if (!result.pose || result.pose->used().size() < 2) continue;
    if (i >= 200) {
      MarkerView lone = view;
      lone.detections = {view.detections[3]};  // well off the image's middle: no second pose
      view.noise_scale = noise.scale(0, imageNoise(*result.pose)[0]);
      const auto squared = [&](const MarkerView& seen) {
        const auto pose = locator.locate(room(), {seen}).pose;
        if (!pose) return 0.0;
        const Eigen::Vector3d e = poseError(kTruth, pose->T_map_base).head<3>();
        return e.dot(pose->covariance.topLeftCorner<3, 3>().ldlt().solve(e));
      };
      ++images;
      far += squared(view) > 14.2;
      lone_far += squared(lone) > 14.2;
    }
    noise.add(*result.pose);
  }
  EXPECT_GT(images, 950);
  EXPECT_NEAR(0.3 * noise.typical(0), 0.2, 0.02);
  EXPECT_LT(far, 0.015 * images);
  EXPECT_LT(lone_far, 0.015 * images);
}

// A moved marker in a third of the images changes their estimates, but not the median.
TEST(CornerNoise, SomeSpoiltImagesDoNotCount) {
  CornerNoise noise;
  std::mt19937 random(4);
  std::chi_squared_distribution<double> chi_squared(6);
  for (int i = 0; i < 200; ++i) {
    const double squares = chi_squared(random) * (i % 3 == 0 ? 8 : 1);
    LocatedPose pose{Pose::Identity(), Matrix6d::Identity(), 0.0, 0.0, 1.0, {}};
    for (int k = 0; k < 3; ++k) pose.markers.push_back({{"tag36h11", k}, 0, true, 0.0, squares / 3, 1.0, {}});
    noise.add(pose);
  }
  EXPECT_LT(noise.typical(0), 1.3);
}

TEST(CornerNoise, IsNotEstimatedSmallerFromASingleMarker) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  CornerNoise noise;
  for (int i = 0; i < 300; ++i) {
    MarkerView view = look(room(), camera, kTruth, 0.1, i);
    view.detections.resize(1);
    const auto result = MarkerLocator(LocatorParams{}).locate(room(), {view});
    if (result.pose) noise.add(*result.pose);
  }
  EXPECT_EQ(noise.scale(0), 1.0);
}

TEST(CornerNoise, SingleMarkersDoNotShowHowMuchImagesDiffer) {
  CornerNoise noise;
  for (int i = 0; i < 200; ++i) noise.add(0, {{}, {i % 2 ? 0.02 : 40.0, 2}});
  EXPECT_EQ(noise.scale(0), noise.typical(0));
}

// The positions of a wrong map are not noise: the residuals of the poses are 3 pixels.
TEST(CornerNoise, DoesNotContainErrorsOfTheMap) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  LocatorParams params;
  params.max_reprojection_error = 100;
  params.gate = 1e6;
  MarkerMap wrong;
  const MarkerMap exact = room();
  for (auto [key, marker] : exact.markers()) {
    marker.T_map_marker.translation().z() += 0.03 * (key.id % 2);
    wrong.add(marker);
  }
  CornerNoise noise;
  for (int i = 0; i < 200; ++i) {
    const auto result = MarkerLocator(params).locate(wrong, {look(room(), camera, kTruth, 0.1, i)});
    ASSERT_TRUE(result.pose) << result.reason;
    noise.add(*result.pose);
  }
  EXPECT_GT(0.3 * noise.typical(0), 0.1);
  EXPECT_LT(0.3 * noise.typical(0), 0.18);
}

}  // namespace
}  // namespace sextant
