// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/corner_noise.hpp"

#include <gtest/gtest.h>

#include "test_cameras.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

// The scale after so many images of two cameras whose corners have this noise, where 0.3 is assumed.
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
  EXPECT_NEAR(0.3 * noise.scale(0), 0.1, 0.015);
  EXPECT_NEAR(0.3 * noise.scale(1), 0.4, 0.04);
}

TEST(CornerNoise, OneMarkerTeachesNothing) {
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

}  // namespace
}  // namespace sextant
