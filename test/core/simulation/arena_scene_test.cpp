// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/arena_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Vector3f;

constexpr int kFloor = 0, kCeiling = 5;
constexpr int kFirst = ArenaScene::kBackgrounds;

ArenaObject pillar(double x, double y) {
  ArenaObject object;
  object.position = {x, y, 0};
  return object;  // of radius 0.05 m and 0.5 m high
}

ArenaObject ball(double x, double y, double z, double radius) {
  ArenaObject object;
  object.shape = ArenaObject::Shape::ball;
  object.position = {x, y, z};
  object.radius = radius;
  return object;
}

ArenaObject box(double x, double y, const Eigen::Vector2d& sides, double yaw) {
  ArenaObject object = pillar(x, y);
  object.shape = ArenaObject::Shape::box;
  object.sides = sides;
  object.yaw = yaw;
  return object;
}

ArenaScene sceneWith(const std::vector<ArenaObject>& objects) {
  ArenaScene scene{ArenaSceneParams()};  // 8 m by 6 m by 2.5 m
  scene.setObjects(objects);
  return scene;
}

ArenaScene::Ray ray(const Vector3f& from, const Vector3f& to) { return {from, (to - from).normalized()}; }

ArenaScene::Hit hitOf(const ArenaScene& scene, const ArenaScene::Ray& ray) {
  ArenaScene::Hit hit = scene.background(ray);
  for (size_t i = 0; i < scene.objects().size(); ++i) scene.meets(ray, static_cast<int>(i), &hit);
  return hit;
}

TEST(ArenaScene, RaysEndOnFloorWallsAndCeiling) {
  const ArenaScene scene = sceneWith({});
  const std::vector<std::pair<Vector3f, float>> expected = {{{0, 0, -1}, 1.0F}, {{-1, 0, 0}, 4.5F},
                                                            {{1, 0, 0}, 3.5F},  {{0, -1, 0}, 3.0F},
                                                            {{0, 1, 0}, 3.0F},  {{0, 0, 1}, 1.5F}};
  for (size_t surface = 0; surface < expected.size(); ++surface) {
    const auto hit = scene.background({{0.5F, 0, 1}, expected[surface].first});
    EXPECT_EQ(hit.surface, static_cast<int>(surface));
    EXPECT_NEAR(hit.distance, expected[surface].second, 1e-6);
  }
  // at 3-4-5 into the wall x = 4, 1 m to the left of its middle
  EXPECT_NEAR(scene.background(ray({0, -2, 1}, {4, 1, 1})).distance, 5.0, 1e-5);
}

TEST(ArenaScene, APillarIsACylinder) {
  const ArenaScene scene = sceneWith({pillar(2, 0)});
  // 0.03 m aside of the axis the surface lies 0.04 m before it
  auto hit = hitOf(scene, {{0, 0.03F, 0.3F}, {1, 0, 0}});
  EXPECT_EQ(hit.surface, kFirst);
  EXPECT_NEAR(hit.distance, 1.96, 1e-5);
  // downward at 3-4-5, the same way seen from above
  hit = hitOf(scene, ray({0.75F, 0, 1.2F}, {1.95F, 0, 0.3F}));
  EXPECT_NEAR(hit.distance, 1.5, 1e-5);
  EXPECT_EQ(hit.surface, kFirst);
  EXPECT_EQ(hitOf(scene, {{0, 0.0501F, 0.3F}, {1, 0, 0}}).surface, 2);  // past it, into the wall
  EXPECT_EQ(hitOf(scene, {{0, 0, 0.501F}, {1, 0, 0}}).surface, 2);      // above it
  EXPECT_EQ(hitOf(scene, {{0, 0, 0.3F}, {-1, 0, 0}}).surface, 1);       // behind the eye
}

TEST(ArenaScene, APillarHasATop) {
  const ArenaScene scene = sceneWith({pillar(2, 0)});
  const auto hit = hitOf(scene, {{2.04F, 0.02F, 2}, {0, 0, -1}});
  EXPECT_EQ(hit.surface, kFirst);
  EXPECT_NEAR(hit.distance, 1.5, 1e-6);
  EXPECT_EQ(hitOf(scene, {{2.04F, 0.04F, 2}, {0, 0, -1}}).surface, kFloor);
}

TEST(ArenaScene, ABallIsASphere) {
  const ArenaScene scene = sceneWith({ball(2, 1, 1, 0.5)});
  // 0.3 m aside of the middle the surface lies 0.4 m before it
  EXPECT_NEAR(hitOf(scene, {{0, 1, 1.3F}, {1, 0, 0}}).distance, 1.6, 1e-5);
  EXPECT_NEAR(hitOf(scene, {{0, 0.7F, 1}, {1, 0, 0}}).distance, 1.6, 1e-5);
  EXPECT_EQ(hitOf(scene, {{0, 1, 1.501F}, {1, 0, 0}}).surface, 2);
  // of a beam from 0.5 m over it, the half-angle of its silhouette is asin(r / d)
  const double half = std::asin(0.5 / 1.0);
  const auto beam = [&](double angle) {
    const Vector3f along(static_cast<float>(std::sin(angle)), 0, static_cast<float>(-std::cos(angle)));
    return hitOf(scene, {{2, 1, 2}, along}).surface;
  };
  EXPECT_EQ(beam(half - 1e-3), kFirst);
  EXPECT_EQ(beam(half + 1e-3), kFloor);
}

TEST(ArenaScene, ABoxIsACuboid) {
  ArenaScene scene = sceneWith({box(2, 0, {0.6, 0.2}, 0)});
  auto hit = hitOf(scene, {{0, 0.09F, 0.3F}, {1, 0, 0}});
  EXPECT_EQ(hit.surface, kFirst);
  EXPECT_NEAR(hit.distance, 1.7, 1e-5);
  EXPECT_EQ(hitOf(scene, {{0, 0.101F, 0.3F}, {1, 0, 0}}).surface, 2);  // past it
  EXPECT_EQ(hitOf(scene, {{0, 0, 0.501F}, {1, 0, 0}}).surface, 2);     // above it
  EXPECT_EQ(hitOf(scene, {{0, 0, 0.3F}, {-1, 0, 0}}).surface, 1);      // behind the eye
  EXPECT_NEAR(hitOf(scene, {{2.29F, -0.09F, 2}, {0, 0, -1}}).distance, 1.5, 1e-5);
  // turned by 45°, a cube of 0.2 m begins half its diagonal before its middle
  scene = sceneWith({box(2, 0, {0.2, 0.2}, M_PI / 4)});
  EXPECT_NEAR(hitOf(scene, {{0, 0, 0.3F}, {1, 0, 0}}).distance, 2 - 0.1 * std::sqrt(2), 1e-5);
  // turned by 90°, its first side is along y
  scene = sceneWith({box(2, 0, {0.6, 0.2}, M_PI / 2)});
  EXPECT_NEAR(hitOf(scene, {{0, 0.29F, 0.3F}, {1, 0, 0}}).distance, 1.9, 1e-5);
  EXPECT_DOUBLE_EQ(box(2, 0, {0.6, 0.8}, 1).reach(), 0.5);
}

TEST(ArenaScene, TheNearerObjectHidesTheOther) {
  for (const auto& objects :
       {std::vector<ArenaObject>{pillar(2, 0), ball(1, 0, 0.3, 0.1)}, {ball(1, 0, 0.3, 0.1), pillar(2, 0)}}) {
    const ArenaScene scene = sceneWith(objects);
    const auto hit = hitOf(scene, {{0, 0, 0.3F}, {1, 0, 0}});
    EXPECT_EQ(scene.objects()[static_cast<size_t>(hit.surface - kFirst)].shape, ArenaObject::Shape::ball);
    EXPECT_NEAR(hit.distance, 0.9, 1e-6);
  }
}

TEST(ArenaScene, LightIsThatOfLambert) {
  ArenaObject white = pillar(2, 0);
  white.colour = {0.5, 0.25, 1};
  ArenaScene scene = sceneWith({white});
  ArenaLight light;
  light.brightness = 2;
  light.direct = 1;
  light.toward = {-2, 0, 0};
  light.tint = {1, 0.5, 1};
  scene.setLight(light);
  const auto seen = [&](float aside) {
    const ArenaScene::Ray look{{0, aside, 0.3F}, {1, 0, 0}};
    return scene.light(look, hitOf(scene, look), 0.001F);
  };
  EXPECT_TRUE(seen(0).isApprox(Vector3f(1, 0.25F, 2), 1e-4F));
  EXPECT_TRUE(seen(0.03F).isApprox(0.8F * Vector3f(1, 0.25F, 2), 1e-4F));  // cosine of the slant
  light.toward = {1, 0, 0};
  scene.setLight(light);
  EXPECT_TRUE(seen(0).isZero(1e-6F));  // from behind
}

TEST(ArenaScene, FacesOfABoxAreLitByTheirNormals) {
  ArenaScene scene = sceneWith({box(2, 0, {0.2, 0.2}, M_PI / 6)});
  ArenaLight light;
  light.direct = 1;
  light.toward = {-1, 0, 0};
  scene.setLight(light);
  const ArenaScene::Ray look{{0, 0, 0.3F}, {1, 0, 0}};  // at the face that is turned by 30°
  EXPECT_NEAR(scene.light(look, hitOf(scene, look), 0.001F).x(), std::cos(M_PI / 6), 1e-4);
  const ArenaScene::Ray down{{2, 0, 1}, {0, 0, -1}};
  EXPECT_NEAR(scene.light(down, hitOf(scene, down), 0.001F).x(), 0, 1e-4);
}

TEST(ArenaScene, ShadowsLieWhereTheLightIsBlocked) {
  ArenaScene dark = sceneWith({pillar(2, 0)}), bright = sceneWith({pillar(2, 0)});  // 0.5 m high
  ArenaLight light;
  light.direct = 0.6;
  light.toward = {-1, 0, 1};  // the shadow is as long as the pillar is high, along x
  bright.setLight(light);
  light.shadows = 0.5;
  dark.setLight(light);
  const auto share = [&](float x, float y) {
    const ArenaScene::Ray down{{x, y, 1}, {0, 0, -1}};
    return dark.light(down, dark.background(down), 0.001F).x() /
           bright.light(down, bright.background(down), 0.001F).x();
  };
  const float falls =
      0.6F / std::sqrt(2.0F);  // directional light on the floor, beside 0.4 of the ambient light
  EXPECT_NEAR(share(2.4F, 0), (0.4F + 0.5F * falls) / (0.4F + falls), 1e-4);
  EXPECT_NEAR(share(2.4F, 0.049F), share(2.4F, 0), 1e-4);
  for (const auto& [x, y] : {std::pair{2.4F, 0.051F}, {2.56F, 0.0F}, {1.6F, 0.0F}})
    EXPECT_FLOAT_EQ(share(x, y), 1);
}

TEST(ArenaScene, AGlossyFloorMirrorsObjects) {
  ArenaSceneParams params;
  params.gloss = 1;
  ArenaScene glossy(params), dull{ArenaSceneParams()};
  ArenaObject red = pillar(2, 0);
  red.colour = {1, 0, 0};
  for (ArenaScene* const scene : {&glossy, &dull}) {
    scene->setObjects({red});
    ArenaLight light;
    light.direct = 0;
    scene->setLight(light);
  }
  // The mirrored ray meets the pillar as high above the floor as a ray through the floor would meet its image
  // below.
  const ArenaScene::Ray look = ray({0, 0, 0.3F}, {1.5F, 0, 0});
  const auto hit = hitOf(glossy, look);
  ASSERT_EQ(hit.surface, kFloor);
  const float share = 0.04F + 0.96F * std::pow(1 - 0.3F / std::hypot(1.5F, 0.3F), 5.0F);
  const Vector3f before = dull.light(look, hit, 0.001F), seen = glossy.light(look, hit, 0.001F);
  EXPECT_TRUE(seen.isApprox(before + share * (Vector3f(0.8F, 0, 0) - before), 1e-3F));
  // Beside it the wall is mirrored.
  const ArenaScene::Ray aside = ray({0, 0.5F, 0.3F}, {1.5F, 0.5F, 0});
  EXPECT_GT(glossy.light(aside, hitOf(glossy, aside), 0.001F).z(), seen.z());
}

TEST(ArenaScene, DirtDarkensPartsOfAnObject) {
  ArenaObject clean = pillar(2, 0), dirty = clean;
  dirty.dirt = 1;
  const ArenaScene one = sceneWith({clean}), other = sceneWith({dirty});
  int same = 0, darker = 0;
  for (float z = 0.01F; z < 0.5F; z += 0.002F) {
    const ArenaScene::Ray look{{0, 0, z}, {1, 0, 0}};
    const float before = one.light(look, hitOf(one, look), 0.001F).x(),
                after = other.light(look, hitOf(other, look), 0.001F).x();
    EXPECT_LE(after, before);
    ++(after == before ? same : darker);
  }
  EXPECT_GT(same, 40);
  EXPECT_GT(darker, 40);
}

TEST(ArenaScene, APhotoCoversASurface) {
  ArenaScene scene = sceneWith({});  // its floor begins at (-4, -3)
  cv::Mat photo(10, 20, CV_8UC3, cv::Scalar(255, 128, 0));
  photo.colRange(10, 20).setTo(cv::Scalar(0, 255, 0));
  scene.setTexture(kFloor, photo, 2);
  ArenaLight light;
  light.direct = 0;
  scene.setLight(light);
  const auto seen = [&](float x) {
    const ArenaScene::Ray down{{x, 0, 1}, {0, 0, -1}};
    return scene.light(down, scene.background(down), 0.001F);
  };
  const float half = std::pow(128 / 255.0F, 2.2F);
  EXPECT_TRUE(seen(-3.5F).isApprox(Vector3f(1, half, 0), 1e-3F));
  EXPECT_TRUE(seen(-2.5F).isApprox(Vector3f(0, 1, 0), 1e-3F));
  EXPECT_TRUE(seen(-1.5F).isApprox(seen(-3.5F), 1e-3F));  // the next copy
}

TEST(ArenaScene, ThingsDarkenTheFloorThatTheyTouch) {
  ArenaScene empty = sceneWith({}), full = sceneWith({pillar(2, 0)});
  const auto share = [&](float off) {
    const ArenaScene::Ray down{{2 + off, 0, 1}, {0, 0, -1}};
    return full.light(down, full.background(down), 0.001F).x() /
           empty.light(down, empty.background(down), 0.001F).x();
  };
  EXPECT_LT(share(0.051F), 0.7F);
  EXPECT_LT(share(0.051F), share(0.08F));
  EXPECT_FLOAT_EQ(share(0.2F), 1.0F);
}

TEST(ArenaScene, SurfacesFollowTheirSeed) {
  ArenaSceneParams params;
  const ArenaScene first(params), same(params);
  params.seed = 2;
  const ArenaScene other(params);
  int differences = 0;
  for (float x = -3.9F; x < 4; x += 0.1F) {
    for (const float z : {-1.0F, 1.0F}) {
      const ArenaScene::Ray look = ray({0, 0, 1}, {x, 1, 1 + z});
      const auto hit = first.background(look);
      const Vector3f light = first.light(look, hit, 0.001F);
      EXPECT_TRUE(hit.surface == kFloor || hit.surface == kCeiling || hit.distance > 2);
      EXPECT_EQ(light, same.light(look, hit, 0.001F));
      if (!light.isApprox(other.light(look, hit, 0.001F), 0.01F)) ++differences;
    }
  }
  EXPECT_GT(differences, 100);
}

template <class Params, class Change>
std::string refusalOf(Change change) {
  Params params;
  change(params);
  return refusal<std::invalid_argument>([&] { validate(params); });
}

TEST(ArenaScene, WhatIsOutOfRangeIsRefusedByName) {
  using Scene = ArenaSceneParams;
  using Light = ArenaLight;
  EXPECT_EQ(refusalOf<Scene>([](Scene& p) { p.size.y() = 0.5; }), "size is 0.5, allowed is [1, 100] m");
  EXPECT_EQ(refusalOf<Scene>([](Scene& p) { p.wall_height = 0; }).find("wall_height is 0"), 0U);
  EXPECT_EQ(refusalOf<Scene>([](Scene& p) { p.seed = -1; }).find("seed is -1"), 0U);
  EXPECT_EQ(refusalOf<Light>([](Light& p) { p.brightness = -1; }).find("brightness is -1"), 0U);
  EXPECT_EQ(refusalOf<Light>([](Light& p) { p.direct = 1.5; }).find("direct is 1.5"), 0U);
  EXPECT_EQ(refusalOf<Light>([](Light& p) { p.tint.z() = 11; }).find("tint is 11"), 0U);
  EXPECT_EQ(refusalOf<Light>([](Light& p) { p.toward.setZero(); }).find("toward's length is 0"), 0U);
}

TEST(ArenaScene, ObjectsThatCannotBeAreRefusedAndTheOthersStay) {
  ArenaScene scene = sceneWith({pillar(2, 0)});
  const auto refused = [&](auto change) {
    ArenaObject object;
    change(object);
    return refusal<std::invalid_argument>([&] { scene.setObjects({object, object}); });
  };
  EXPECT_EQ(refused([](ArenaObject& o) { o.radius = 0; }), "radius is 0, allowed is (0, 10] m");
  EXPECT_EQ(refused([](ArenaObject& o) { o.height = -1; }).find("height is -1"), 0U);
  EXPECT_EQ(refused([](ArenaObject& o) { o.sides.y() = 0; }), "sides is 0, allowed is (0, 10] m");
  EXPECT_EQ(refused([](ArenaObject& o) { o.dirt = 2; }), "dirt is 2, allowed is [0, 1]");
  EXPECT_EQ(refused([](ArenaObject& o) { o.colour.y() = 1.5; }).find("colour is 1.5"), 0U);
  EXPECT_EQ(scene.objects().size(), 1U);
  const cv::Mat photo(2, 2, CV_8UC3, cv::Scalar::all(0));
  const auto texture = [&](int surface, const cv::Mat& each, double width) {
    return refusal<std::invalid_argument>([&] { scene.setTexture(surface, each, width); });
  };
  EXPECT_EQ(texture(6, photo, 1), "surface is 6, allowed is [0, 5]");
  EXPECT_EQ(texture(0, photo, 0), "width is 0, allowed is [0.1, 20] m");
  EXPECT_EQ(texture(0, cv::Mat(2, 2, CV_8U), 1), "a texture must be an RGB photo");
  EXPECT_EQ(texture(0, cv::Mat(), 1), "a texture must be an RGB photo");
}

}  // namespace
}  // namespace sextant
