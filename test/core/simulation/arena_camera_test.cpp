// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/arena_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "test_arena.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

std::vector<VisibleObject> visibleObjects(const ArenaScene& scene, const Pose& T_map_camera) {
  return ArenaCamera({}, pinhole()).take(scene, T_map_camera, 0).objects;
}

// Sides of the two planes through an eye that touch a circle: f tan(angle to its middle ± asin(r / d)).
Eigen::Vector2d tangents(double aside, double ahead, double radius) {
  const double middle = std::atan2(aside, ahead), half = std::asin(radius / std::hypot(aside, ahead));
  return {kFocal * std::tan(middle - half), kFocal * std::tan(middle + half)};
}

void expectBox(const VisibleObject& seen, const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
  // the first and the last pixel whose centre it covers
  EXPECT_NEAR(seen.low.x(), std::ceil(kCx + u[0]), 1);
  EXPECT_NEAR(seen.high.x(), std::floor(kCx + u[1]) + 1, 1);
  EXPECT_NEAR(seen.low.y(), std::ceil(kCy + v[0]), 1);
  EXPECT_NEAR(seen.high.y(), std::floor(kCy + v[1]) + 1, 1);
}

TEST(ArenaCamera, TheBoxOfABallIsThatOfItsSilhouette) {
  for (const Eigen::Vector3d& off :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1.5, 0.8, -0.4), Eigen::Vector3d(3, -1.5, 0.9)}) {
    const auto seen = visibleObjects(hall({ball(off.x(), off.y(), 2 + off.z())}), levelAt(0, 2));
    ASSERT_EQ(seen.size(), 1U);
    const Eigen::Vector2d u = tangents(-off.y(), off.x(), 0.1), v = tangents(-off.z(), off.x(), 0.1);
    expectBox(seen[0], u, v);
    if (off.y() == 0) {
      EXPECT_NEAR(seen[0].pixels, M_PI / 4 * (u[1] - u[0]) * (v[1] - v[0]), 30);
    }
  }
}

TEST(ArenaCamera, TheMaskHasThePixelsOfTheObjects) {
  ArenaCamera camera({}, pinhole());
  ArenaObject crate = pillar(2, 0.6);
  crate.shape = ArenaObject::Shape::box;
  crate.yaw = 0.5;
  const auto seen = camera.take(hall({ball(1.5, -0.4, 0.8), crate}), levelAt(0, 0.8), 0).objects;
  ASSERT_EQ(seen.size(), 2U);
  const cv::Mat mask = camera.mask();
  EXPECT_EQ(cv::countNonZero(mask), seen[0].pixels + seen[1].pixels);
  for (const VisibleObject& each : seen) {
    const cv::Rect part(each.low.x(), each.low.y(), each.high.x() - each.low.x(),
                        each.high.y() - each.low.y());
    EXPECT_EQ(cv::countNonZero(mask(part)), each.pixels);
  }
}

TEST(ArenaCamera, TheBoxOfAPillarIsThatOfItsSilhouette) {
  const double eye = 0.8, radius = 0.1;
  for (const double height : {0.5, 1.2}) {  // its top is seen, or not
    for (const double distance : {1.5, 3.0}) {
      const auto seen = visibleObjects(hall({pillar(distance, 0, radius, height)}), levelAt(0, eye));
      ASSERT_EQ(seen.size(), 1U);
      const double top = distance + (height < eye ? radius : -radius);
      const double foot = distance - radius;
      expectBox(seen[0], tangents(0, distance, radius),
                {kFocal * (eye - height) / top, std::min(kFocal * eye / foot, 479 - kCy)});
    }
  }
}

TEST(ArenaCamera, WhatIsHiddenIsNotSeenAndWhatSticksOutIs) {
  // a ball of the same radius half behind a pillar: its right half is seen
  auto seen = visibleObjects(hall({pillar(1, 0, 0.1, 2), ball(2, -0.2, 0.5)}), levelAt(0, 0.5));
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_NEAR(seen[1].low.x(), std::ceil(kCx + tangents(0, 1, 0.1)[1]), 1);
  EXPECT_NEAR(seen[1].high.x(), std::floor(kCx + tangents(0.2, 2, 0.1)[1]) + 1, 1);
  seen = visibleObjects(hall({ball(2, 0, 0.5), pillar(1, 0, 0.1, 2)}), levelAt(0, 0.5));
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].object, 1);
  EXPECT_TRUE(visibleObjects(hall({pillar(-1, 0)}), levelAt(0, 0.5)).empty());  // behind the camera
  EXPECT_EQ(visibleObjects(hall({pillar(0.05, 0, 0.1, 0.3)}), cameraPose({0, 0, 1}, {0, 1.5, 0})).size(), 1U);
}

TEST(ArenaCamera, TheImageFollowsTheLight) {
  ArenaCameraParams params;
  params.noise_sigma = 0;
  params.gamma = 2;
  ArenaCamera camera(params, pinhole());
  ArenaObject grey = pillar(1, 0, 0.3, 2);
  grey.colour = {0.6, 0.3, 0.15};
  ArenaScene scene = hall({grey});
  ArenaLight light;
  light.direct = 1;
  light.toward = {-1, 0, 0};
  for (const double brightness : {0.25, 1.0, 4.0}) {
    light.brightness = brightness;
    scene.setLight(light);
    const auto pixel = camera.take(scene, levelAt(0, 1), 0).image.at<cv::Vec3b>(240, 320);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(pixel[c], std::min(255.0, 230 * std::sqrt(std::min(2.0, brightness * grey.colour[c]))),
                  1.5);
  }
}

TEST(ArenaCamera, NoiseHasTheSpreadThatWasAskedFor) {
  ArenaCameraParams params;
  params.noise_sigma = 0;
  const cv::Mat without = ArenaCamera(params, pinhole()).take(hall(), levelAt(0, 2), 0).image;
  params.noise_sigma = 5;
  ArenaCamera noisy(params, pinhole());
  cv::Mat noise[2];
  for (int frame = 0; frame < 2; ++frame)
    cv::subtract(noisy.take(hall(), levelAt(0, 2), static_cast<std::uint64_t>(frame)).image, without,
                 noise[frame], cv::noArray(), CV_32F);
  cv::Scalar mean, deviation;
  cv::meanStdDev(noise[0], mean, deviation);
  EXPECT_NEAR(deviation[0], 5, 0.2);
  EXPECT_NEAR(noise[0].dot(noise[1]) / (25.0 * 3 * noise[0].total()), 0, 0.02);  // frames are independent
}

TEST(ArenaCamera, TheSameFrameGivesTheSameBytes) {
  const ArenaScene scene = hall({pillar(1, 0), ball(1, 0.3, 0.1)});
  ArenaCameraParams params;
  ArenaCamera camera(params, pinhole());
  const cv::Mat image = camera.take(scene, levelAt(0, 0.3), 7).image.clone();
  const auto differs = [&](const cv::Mat& other) {
    const cv::Mat unequal = image != other;
    return cv::countNonZero(unequal.reshape(1)) > 100000;
  };
  EXPECT_TRUE(differs(camera.take(scene, levelAt(0, 0.3), 8).image));
  EXPECT_EQ(cv::norm(image, camera.take(scene, levelAt(0, 0.3), 7).image, cv::NORM_INF), 0);
  params.seed = 2;
  EXPECT_TRUE(differs(ArenaCamera(params, pinhole()).take(scene, levelAt(0, 0.3), 7).image));
}

TEST(ArenaCamera, APixelOnAnEdgeIsAMixture) {
  ArenaCameraParams params;
  params.noise_sigma = params.blur_sigma = 0;
  params.gamma = 1;
  params.supersampling = 8;
  ArenaObject black = pillar(1, 0, 0.1, 3);
  black.colour.setZero();
  ArenaScene scene = hall({black, pillar(4.9, 0, 3, 9)});  // before a white one that fills the image
  ArenaLight even;
  even.direct = 0;
  scene.setLight(even);
  const auto row = ArenaCamera(params, pinhole()).take(scene, levelAt(0, 1), 0).image.row(240);
  double covered = 0;
  for (int x = 270; x < 370; ++x) covered += 1.0 - row.at<cv::Vec3b>(0, x)[0] / (0.8 * 230);
  const Eigen::Vector2d sides = tangents(0, 1, 0.1);
  EXPECT_NEAR(covered, sides[1] - sides[0], 0.2);  // pixels
}

TEST(ArenaCamera, IsBlackWhereTheLensHasNoRay) {
  // 1 + 3 k1 r^2 = 0 at r = 0.816: the model's image ends 0.544 f = 109 px from the middle
  ArenaCamera camera({}, pinhole(200, {-0.5, 0, 0, 0, 0}));
  const cv::Mat image = camera.take(hall(), levelAt(0, 2), 0).image;
  EXPECT_LT(image.at<cv::Vec3b>(20, 322)[1], 20);  // noise
  EXPECT_GT(image.at<cv::Vec3b>(238, 322)[1], 60);
}

TEST(ArenaCamera, RefusesWhatCannotBe) {
  for (const Eigen::Vector3d& out : {Eigen::Vector3d(5, 0, 1), {0, -5, 1}, {0, 0, 0}, {0, 0, 10}})
    EXPECT_EQ(refusal<std::invalid_argument>([&] {
                visibleObjects(hall(), cameraPose(out, {0, 0, 0}));
              }),
              "the camera is outside the arena");
  const auto refused = [](auto change) {
    ArenaCameraParams params;
    change(params);
    return refusal<std::invalid_argument>([&] { ArenaCamera(params, pinhole()); });
  };
  EXPECT_EQ(refused([](auto& p) { p.supersampling = 0; }), "supersampling is 0, allowed is [1, 8]");
  EXPECT_EQ(refused([](auto& p) { p.blur_sigma = 21; }), "blur_sigma is 21, allowed is [0, 20] px");
  EXPECT_EQ(refused([](auto& p) { p.noise_sigma = -1; }), "noise_sigma is -1, allowed is [0, 100] levels");
  EXPECT_EQ(refused([](auto& p) { p.white_level = 0; }), "white_level is 0, allowed is (0, 1000] levels");
  EXPECT_EQ(refused([](auto& p) { p.gamma = 5; }), "gamma is 5, allowed is [0.5, 4]");
  EXPECT_NE(refused([](auto& p) { p.seed = -1; }).find("seed is -1"), std::string::npos);
}

}  // namespace
}  // namespace sextant
