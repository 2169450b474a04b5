// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/room_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

constexpr double kPi = 3.14159265358979323846;

RoomSceneParams emptyRoom() {
  RoomSceneParams params;
  params.obstacles.clear();
  params.light_unevenness = 0.0;
  return params;
}

// A marker of 0.2 m in the middle of the wall x = 3, 1 m above the floor.
MarkerMap oneMarker(const std::string& family, int id) {
  MarkerMap map;
  map.add(
      {{family, id}, 0.2, "", poseFromXyzRpy({3.0, 0.0, 1.0}, {kPi / 2, 0.0, -kPi / 2}), Matrix6d::Zero()});
  return map;
}

RoomRay ray(const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  return {from, (to - from).normalized()};
}

TEST(RoomScene, RaysEndOnTheWallsOfA6By6By2AndAHalfRoom) {
  const RoomScene scene(emptyRoom(), MarkerMap());
  const Eigen::Vector3f middle(0.0F, 0.0F, 1.0F);
  const std::vector<std::pair<Eigen::Vector3f, float>> expected = {{{-1, 0, 0}, 3.0F}, {{1, 0, 0}, 3.0F},
                                                                   {{0, -1, 0}, 3.0F}, {{0, 1, 0}, 3.0F},
                                                                   {{0, 0, -1}, 1.0F}, {{0, 0, 1}, 1.5F}};
  for (std::size_t face = 0; face < expected.size(); ++face) {
    const RoomHit hit = scene.trace({middle, expected[face].first}, {});
    EXPECT_EQ(hit.surface, static_cast<int>(face));
    EXPECT_NEAR(hit.distance, expected[face].second, 1e-6);
  }
  // into the wall x = 3 at 3-4-5 from (0, -2)
  EXPECT_NEAR(scene.trace(ray({-1.0F, -2.0F, 1.0F}, {3.0F, 1.0F, 1.0F}), {}).distance, 5.0, 1e-5);
}

TEST(RoomScene, AnObstacleHidesTheWall) {
  RoomSceneParams params = emptyRoom();
  params.obstacles = {{{2.0, 0.0, 0.5}, {0.4, 0.4, 1.0}, 0.25}};
  const RoomScene scene(params, MarkerMap());
  EXPECT_NEAR(scene.trace({{0, 0, 0.5F}, {1, 0, 0}}, {0}).distance, 1.8, 1e-6);
  EXPECT_NEAR(scene.trace({{0, 0, 1.1F}, {1, 0, 0}}, {0}).distance, 3.0, 1e-6);   // above it
  EXPECT_NEAR(scene.trace({{0, 0, 0.5F}, {-1, 0, 0}}, {0}).distance, 3.0, 1e-6);  // behind the eye
}

TEST(RoomScene, APrintHasItsModulesWhereTheFamilySaysAndWhiteAround) {
  for (const std::string family : {"tag36h11", "DICT_4X4_50", "tagStandard41h12"}) {
    const RoomScene scene(emptyRoom(), oneMarker(family, 3));
    const MarkerImage image = markerImage(family, 3);
    const double module = 0.2 / (image.border_end - image.border_begin);
    const double middle = 0.5 * (image.border_begin + image.border_end);
    for (int row = -1; row <= image.modules.rows; ++row) {
      for (int column = -1; column <= image.modules.cols; ++column) {
        // as one looks at the wall x = 3, right is -y
        const Eigen::Vector3f target(3.0F, static_cast<float>((middle - column - 0.5) * module),
                                     static_cast<float>(1.0 + (middle - row - 0.5) * module));
        const RoomRay to_module = ray({1.0F, 0.3F, 1.4F}, target);
        const bool margin =
            row < 0 || column < 0 || row == image.modules.rows || column == image.modules.cols;
        const float expected = margin || image.modules.at<std::uint8_t>(row, column) > 127 ? 1.0F : 0.06F;
        const RoomHit hit = scene.trace(to_module, {0});
        EXPECT_FLOAT_EQ(scene.radiance(to_module, hit, 0.001F), expected)
            << family << " " << row << " " << column;
      }
    }
  }
}

TEST(RoomScene, TheQuietZoneIsAsWideAsAsked) {
  RoomSceneParams params = emptyRoom();
  params.quiet_zone = 2.0;
  const RoomScene scene(params, oneMarker("DICT_4X4_50", 0));  // 6 modules: 0.2 m / 6 each
  const auto at = [&scene](double y) {
    return scene.trace(ray({0, 0, 1}, {3.0F, static_cast<float>(y), 1.0F}), {0}).surface >= RoomScene::kFaces;
  };
  EXPECT_TRUE(at(0.1 + 1.95 * 0.2 / 6));
  EXPECT_FALSE(at(0.1 + 2.05 * 0.2 / 6));
}

TEST(RoomScene, ABoardIsGreyFromBehind) {
  MarkerMap map;
  map.add({{"tag36h11", 0},
           0.2,
           "",
           poseFromXyzRpy({1.0, 0.0, 1.0}, {kPi / 2, 0.0, -kPi / 2}),
           Matrix6d::Zero()});
  const RoomScene scene(emptyRoom(), map);
  const RoomRay back = ray({2.5F, 0, 1}, {1, 0.01F, 1.01F});
  EXPECT_FLOAT_EQ(scene.radiance(back, scene.trace(back, {0}), 0.001F), 0.4F);
}

TEST(RoomScene, OutlinesHoldTheWholeObject) {
  const RoomScene scene(RoomSceneParams(), oneMarker("tag36h11", 0));
  ASSERT_EQ(scene.objectCount(), 5);
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (const Eigen::Vector3d& p : scene.outline(4)) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double half =
      0.1 + 2 * 0.2 / 8;  // 8 modules make 0.2 m; around them the family's white one and a margin of one
  EXPECT_TRUE(low.isApprox(Eigen::Vector3d(3.0, -half, 1.0 - half), 1e-5)) << low.transpose();
  EXPECT_TRUE(high.isApprox(Eigen::Vector3d(3.0, half, 1.0 + half), 1e-5)) << high.transpose();
}

TEST(RoomScene, LightIsEvenOrNot) {
  RoomSceneParams params = emptyRoom();
  const RoomScene even(params, MarkerMap());
  params.light_unevenness = 1.0;
  const RoomScene uneven(params, MarkerMap());
  EXPECT_FLOAT_EQ(even.illumination({-3, -3, 0}), even.illumination({3, 3, 2}));
  EXPECT_GT(uneven.illumination({3, 3, 2}), 1.3 * uneven.illumination({-3, -3, 0}));
}

TEST(RoomScene, RefusesWhatCannotBe) {
  MarkerMap outside;
  outside.add({{"tag36h11", 0}, 0.2, "", poseFromXyzRpy({5, 0, 1}, {0, 0, 0}), Matrix6d::Zero()});
  EXPECT_THROW(RoomScene(emptyRoom(), outside), std::invalid_argument);
  const auto refused = [](auto change) {
    RoomSceneParams params;
    change(params);
    EXPECT_THROW(validate(params), std::invalid_argument);
  };
  refused([](RoomSceneParams& p) { p.size.y() = 0.0; });
  refused([](RoomSceneParams& p) { p.floor_center.x() = std::numeric_limits<double>::quiet_NaN(); });
  refused([](RoomSceneParams& p) { p.quiet_zone = 0.5; });
  refused([](RoomSceneParams& p) { p.light_unevenness = -0.1; });
  refused([](RoomSceneParams& p) { p.seed = -1; });
  refused([](RoomSceneParams& p) { p.obstacles[0].size.z() = 0.0; });
  refused([](RoomSceneParams& p) { p.obstacles[0].reflectance = 2.0; });
}

}  // namespace
}  // namespace sextant
