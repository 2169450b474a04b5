// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/depth_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "test_arena.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

DepthCameraParams clean() {
  DepthCameraParams params;
  params.noise = params.holes = params.baseline = 0;
  return params;
}

cv::Mat_<float> depthOf(const DepthCameraParams& params, const ArenaScene& scene, const Pose& T_map_camera,
                        std::uint64_t frame = 0) {
  return DepthCamera(params, pinhole()).take(scene, T_map_camera, frame);
}

// Of the middle of a wall that is so far away, in which the scale is 1 and nothing else errs.
cv::Mat_<float> errorsAt(double distance, const DepthCameraParams& params, std::uint64_t frame = 0) {
  static const ArenaScene scene = hall();
  const cv::Mat_<float> depth = depthOf(params, scene, levelAt(5 - distance, 5), frame);
  return depth(cv::Rect(60, 40, 520, 400)) - distance;
}

double deviationOf(const cv::Mat& errors) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(errors, mean, deviation);
  return deviation[0];
}

TEST(DepthCamera, DepthIsAlongTheOpticalAxis) {
  const ArenaScene scene = hall({pillar(2, 0.3)});
  const cv::Mat_<float> depth = depthOf(clean(), scene, levelAt(0, 1));
  for (const cv::Point& p : {cv::Point(10, 20), {400, 100}, {600, 239}}) EXPECT_NEAR(depth(p), 5, 1e-5);
  for (const int row : {350, 400, 470})  // the floor
    EXPECT_NEAR(depth(row, 500), kFocal * 1 / (row - kCy), 1e-4);
  // Rays in a plane through the eye and upright: aside = depth (column - kCx) / f; the pillar's circle there.
  for (const int column : {246, 252, 260, 267}) {
    const double slope = -(column - kCx) / kFocal, a = 1 + slope * slope, b = 2 + 0.3 * slope;
    EXPECT_NEAR(depth(390, column), (b - std::sqrt(b * b - a * (4 + 0.09 - 0.01))) / a, 1e-4) << column;
  }
}

TEST(DepthCamera, ScaleIsWhatItSaysOfAMetre) {
  DepthCameraParams params = clean();
  params.scale = 1 / 1.04;
  EXPECT_NEAR(depthOf(params, hall(), levelAt(1, 5))(240, 320), 4 / 1.04, 1e-5);
}

TEST(DepthCamera, NoiseGrowsWithTheSquareOfTheDepth) {
  DepthCameraParams params = clean();
  params.noise = 0.004;
  for (const double distance : {0.5, 1.0, 2.0, 4.0}) {
    const double expected = params.noise * distance * distance;
    EXPECT_NEAR(deviationOf(errorsAt(distance, params)), expected, 0.05 * expected) << distance;
    EXPECT_NEAR(cv::mean(errorsAt(distance, params))[0], 0, 0.1 * expected);
  }
}

TEST(DepthCamera, NoiseComesInLumpsAsThoseOfAStereoMatchersWindow) {
  DepthCameraParams params = clean();
  params.noise = 0.01;
  const cv::Mat_<float> errors = errorsAt(1, params);
  const double variance = errors.dot(errors) / static_cast<double>(errors.total());
  const auto correlation = [&](int x, int y) {
    const cv::Rect here(0, 0, errors.cols - x, errors.rows - y), there = here + cv::Point(x, y);
    return errors(here).dot(errors(there)) / here.area() / variance;
  };
  // means over windows 7 pixels wide share 1 - lag / 7 of what they average
  for (const auto& [x, y] : {std::pair(0, 1), {3, 0}, {0, 3}, {2, 2}, {7, 0}, {0, 9}, {20, 20}}) {
    EXPECT_NEAR(correlation(x, y), std::max(0.0, 1 - x / 7.0) * std::max(0.0, 1 - y / 7.0), 0.06)
        << x << " " << y;
  }
}

TEST(DepthCamera, FramesHaveNoiseOfTheirOwnAndTheSameFrameTheSameBytes) {
  DepthCameraParams params;
  const cv::Mat_<float> first = errorsAt(1, params, 1), second = errorsAt(1, params, 2);
  EXPECT_EQ(cv::norm(first, errorsAt(1, params, 1), cv::NORM_INF), 0);
  params.holes = 0;
  cv::Mat_<float> noise[3];
  for (int frame = 0; frame < 3; ++frame)
    noise[frame] = errorsAt(1, params, static_cast<std::uint64_t>(frame)) / params.noise;
  for (const auto& [a, b] : {std::pair(0, 1), {1, 2}, {0, 2}})
    EXPECT_NEAR(noise[a].dot(noise[b]) / static_cast<double>(noise[0].total()), 0, 0.06);
  params.seed = 2;
  EXPECT_GT(cv::norm(errorsAt(1, params, 1), noise[1] * params.noise, cv::NORM_INF), params.noise);
}

TEST(DepthCamera, HolesHaveTheirShareAndFollowTheFrame) {
  DepthCameraParams params = clean();
  params.holes = 0.2;
  const cv::Mat_<float> depth = depthOf(params, hall(), levelAt(0, 5), 1);
  EXPECT_NEAR(cv::countNonZero(depth == 0) / static_cast<double>(depth.total()), 0.2, 0.015);
  const cv::Mat both = (depth == 0) & (depthOf(params, hall(), levelAt(0, 5), 2) == 0);
  EXPECT_NEAR(cv::countNonZero(both) / static_cast<double>(depth.total()), 0.04, 0.01);
}

TEST(DepthCamera, DepthsRunIntoEachOtherAtEdges) {
  DepthCameraParams params = clean();
  const ArenaScene scene = hall({pillar(2, 0, 0.1, 9)});
  const cv::Mat_<float> sharp = depthOf(params, scene, levelAt(0, 5)).row(100);
  params.bleeding = 2;
  const cv::Mat_<float> bled = depthOf(params, scene, levelAt(0, 5)).row(100);
  const int edge =
      static_cast<int>(std::lround(kCx + kFocal * std::tan(std::asin(0.1 / 2)) + 0.5));  // first of the wall
  ASSERT_LT(sharp(0, edge - 1), 2.1);
  ASSERT_NEAR(sharp(0, edge), 5, 1e-5);
  for (int off = -2; off < 2;
       ++off)  // a window of five columns: the mean of those before and behind the edge
    EXPECT_NEAR(bled(0, edge + off), cv::mean(sharp.colRange(edge + off - 2, edge + off + 3))[0], 1e-3)
        << off;
  for (const int off : {-3, 2, 20}) EXPECT_EQ(bled(0, edge + off), sharp(0, edge + off)) << off;
  params.holes = 0.2;
  params.noise = 0.03;
  const cv::Mat_<float> noisy = depthOf(params, scene, levelAt(0, 5)), wall = errorsAt(3, params);
  params.bleeding = 0;
  const cv::Mat_<float> without = depthOf(params, scene, levelAt(0, 5));
  EXPECT_EQ(cv::norm(noisy == 0, without == 0, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(wall, errorsAt(3, params), cv::NORM_INF), 0);  // noise is no edge
}

TEST(DepthCamera, WhatTheOtherCameraDoesNotSeeHasNoDepth) {
  DepthCameraParams params = clean();
  params.baseline = 0.06;
  for (const double distance : {0.5, 1.0, 2.0}) {
    const cv::Mat_<float> row = depthOf(params, hall({pillar(distance, 0, 0.05, 9)}), levelAt(0, 5)).row(100);
    // f b (1 / z - 1 / z'), to the left of what is near
    EXPECT_NEAR(cv::countNonZero(row == 0), kFocal * 0.06 * (1 / distance - 1.0 / 5), 1.5) << distance;
    const int edge = static_cast<int>(kCx - kFocal * std::tan(std::asin(0.05 / distance)));
    EXPECT_EQ(row(0, edge - 1), 0);
    EXPECT_GT(row(0, edge + 2), 0);
    EXPECT_GT(row(0, 400), 0);
  }
}

TEST(DepthCamera, WhatIsTooNearOrTooFarHasNoDepth) {
  DepthCameraParams params = clean();
  const ArenaScene scene = hall({pillar(1, 0, 0.1, 9)});
  params.max_depth = 4.9;
  EXPECT_EQ(depthOf(params, scene, levelAt(0, 5))(240, 100), 0);
  EXPECT_NEAR(depthOf(params, scene, levelAt(0, 5))(240, 320), 0.9, 1e-3);
  params.min_depth = 0.95;
  params.max_depth = 10;
  EXPECT_NEAR(depthOf(params, scene, levelAt(0, 5))(240, 100), 5, 1e-3);
  EXPECT_EQ(depthOf(params, scene, levelAt(0, 5))(240, 320), 0);
}

TEST(DepthCamera, WhereTheLensHasNoRayIsNoDepthAndTheRestIsAsEver) {
  // the image of such a lens ends 109 px from the middle, see ArenaCamera
  DepthCameraParams params = clean();
  params.baseline = 0.05;
  const cv::Mat_<float> depth =
      DepthCamera(params, pinhole(200, {-0.5, 0, 0, 0, 0})).take(hall(), levelAt(0, 5), 0);
  EXPECT_EQ(depth(240, 600), 0);
  EXPECT_NEAR(depth(240, 320), 5, 1e-3);
}

TEST(DepthCamera, RefusesWhatCannotBe) {
  EXPECT_EQ(refusal<std::invalid_argument>([] { depthOf(clean(), hall(), levelAt(5.1, 1)); }),
            "the camera is outside the arena");
  const auto refused = [](auto change) {
    DepthCameraParams params;
    change(params);
    return refusal<std::invalid_argument>([&] { DepthCamera(params, pinhole()); });
  };
  EXPECT_EQ(refused([](auto& p) { p.noise = -1; }), "noise is -1, allowed is [0, 1] m");
  EXPECT_EQ(refused([](auto& p) { p.scale = 3; }), "scale is 3, allowed is [0.5, 2]");
  EXPECT_EQ(refused([](auto& p) { p.baseline = 2; }), "baseline is 2, allowed is [0, 1] m");
  EXPECT_EQ(refused([](auto& p) { p.min_depth = -1; }), "min_depth is -1, allowed is [0, 10] m");
  EXPECT_EQ(refused([](auto& p) { p.max_depth = 0.1; }), "max_depth is 0.1, allowed is (0.28, 100] m");
  EXPECT_EQ(refused([](auto& p) { p.holes = 2; }), "holes is 2, allowed is [0, 1]");
  EXPECT_NE(refused([](auto& p) { p.seed = -1; }).find("seed is -1"), std::string::npos);
}

}  // namespace
}  // namespace sextant
