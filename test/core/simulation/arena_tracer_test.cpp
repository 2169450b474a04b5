// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arena_tracer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "test_arena.hpp"

namespace sextant {
namespace {

TEST(ArenaTracer, RaysEndAtTheNearestSurface) {
  ArenaTracer tracer(pinhole());
  tracer.trace(hall({ball(2, 0, 2, 0.5), ball(4, 0, 2, 1.5)}), levelAt(0, 2));
  // toward the middle, to within the half pixel between four pixels
  EXPECT_NEAR(tracer.distances()(240, 320), 1.5, 1e-4);
  EXPECT_EQ(tracer.surfaces()(240, 320), ArenaScene::kBackgrounds);
  // tan = 0.5: past the first ball (sin = 0.447 of its 2 m), on the wall at 5 m
  const int aside = static_cast<int>(kCx + 0.5 * kFocal + 0.5);
  EXPECT_NEAR(tracer.depth(aside, 240), 5, 1e-4);
  EXPECT_NEAR(tracer.distances()(240, aside), 5 * std::hypot(1, (aside - kCx) / kFocal), 1e-4);
  EXPECT_LT(tracer.surfaces()(240, aside), ArenaScene::kBackgrounds);
  // between both silhouettes: sin of the angle over the second ball's 4 m is less than 1.5 / 4
  const int between = static_cast<int>(kCx + 0.3 * kFocal);
  EXPECT_EQ(tracer.surfaces()(240, between), ArenaScene::kBackgrounds + 1);
  EXPECT_FLOAT_EQ(tracer.pixelAngle(), 1 / kFocal);
}

TEST(ArenaTracer, ARayBesideThePixelsCentreGoesThere) {
  const CameraModel camera = pinhole();
  ArenaTracer tracer(camera);
  const Pose T_map_camera = cameraPose({1, 2, 3}, {0.1, -0.2, 0.7});
  tracer.trace(hall(), T_map_camera);
  for (const Eigen::Vector2f& off : {Eigen::Vector2f(0, 0), {0.5F, 0}, {-0.25F, 0.4F}}) {
    const ArenaScene::Ray ray = tracer.ray(500, 100, off);
    const Eigen::Vector3d there = *camera.unproject({500 + off.x(), 100 + off.y()});
    EXPECT_LT((ray.direction.cast<double>() - T_map_camera.linear() * there).norm(), 1e-5);
    EXPECT_EQ(ray.origin, Eigen::Vector3f(1, 2, 3));
  }
}

TEST(ArenaTracer, WhereTheLensHasNoRayThereIsNothing) {
  // 1 + 3 k1 r^2 = 0 at r = 0.816: the model's image ends 0.544 f = 109 px from the middle
  ArenaTracer tracer(pinhole(200, {-0.5, 0, 0, 0, 0}));
  tracer.trace(hall({ball(2, 0, 2, 1.9)}), levelAt(0, 2));
  EXPECT_EQ(tracer.surfaces()(20, 322), ArenaTracer::kNothing);
  EXPECT_EQ(tracer.surfaces()(239, 319), ArenaScene::kBackgrounds);
}

TEST(ArenaTracer, MovesWithTheCameraAndTheObjects) {
  const ArenaScene scene = hall({pillar(2, 0)});
  ArenaTracer tracer(pinhole());
  tracer.trace(scene, levelAt(0, 0.25));
  EXPECT_EQ(tracer.surfaces()(240, 320), ArenaScene::kBackgrounds);
  tracer.trace(scene, levelAt(3, 0.25));  // it is behind the camera
  EXPECT_NEAR(tracer.depth(320, 240), 2, 1e-4);
  EXPECT_LT(tracer.surfaces()(240, 320), ArenaScene::kBackgrounds);
}

}  // namespace
}  // namespace sextant
