// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_map_matching.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

MapPoint point(double x, double y, const std::string& class_name = "red", double sigma = 0.05) {
  return {{{x, y}, {}}, {class_name, {}}, sigma * sigma * Matrix2d::Identity()};
}

MapPoint tag(int id, double x, double y, double heading) {
  MapPoint marker = point(x, y, "tag", 0.02);
  marker.label.id = id;
  marker.landmark.heading = heading;
  return marker;
}

MapPoint seenBy(const Pose2& T_map_local, const MapPoint& point, const Vector2d& noise = {0, 0}) {
  MapPoint seen = point;
  seen.landmark = toRobotFrame(T_map_local, point.landmark);
  seen.landmark.position += noise;
  return seen;
}

void expectPose(const std::optional<LandmarkMapMatch>& match, const Pose2& T_map_local, double metres,
                double radians) {
  ASSERT_TRUE(match);
  EXPECT_LT((match->T_map_local.position - T_map_local.position).norm(), metres);
  EXPECT_NEAR(wrapped(match->T_map_local.heading - T_map_local.heading), 0, radians);
}

/// A hall with landmarks of three classes, anywhere.
std::vector<MapPoint> hall(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> x(0, 20), y(0, 15);
  const char* const classes[] = {"red", "blue", "green"};
  std::vector<MapPoint> map;
  for (int i = 0; i < count; ++i) {
    const Vector2d position{x(random), y(random)};
    map.push_back(point(position.x(), position.y(), classes[i % 3]));
  }
  return map;
}

// Of the small map six are of the large one, two are not; the large one has many that the small one lacks.
TEST(LandmarkMapMatching, FindsALocalMapInTheMap) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.05);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), near(-3, 3);
  size_t found = 0, right = 0;
  for (int run = 0; run < 20; ++run) {
    std::vector<MapPoint> map = hall(random, 30);
    const Pose2 truth{{8, 6}, angle(random)};
    std::sort(map.begin(), map.end(), [&](const MapPoint& a, const MapPoint& b) {
      return (a.landmark.position - truth.position).norm() < (b.landmark.position - truth.position).norm();
    });
    const Vector2d red{near(random), near(random)}, blue{near(random), near(random)};
    std::vector<MapPoint> local{point(red.x(), red.y()), point(blue.x(), blue.y(), "blue")};
    for (size_t i = 0; i < 6; ++i)
      local.push_back(seenBy(truth, map[i], Vector2d{noise(random), noise(random)}));
    const auto match = matchLandmarkMaps(local, map, {});
    if (!match) continue;
    ++found;
    expectPose(match, truth, 0.2, 0.1);
    for (const auto& [of_local, of_map] : match->pairs) right += of_local == of_map + 2;
  }
  EXPECT_GE(found, 18u);
  EXPECT_GE(right, 55 * found / 10);  // of six
}

TEST(LandmarkMapMatching, RejectsAMapOfAnotherPlace) {
  std::mt19937 random(2);
  int matches = 0;
  for (int run = 0; run < 40; ++run) {
    const std::vector<MapPoint> map = hall(random, 20), other = hall(random, 5);
    matches += matchLandmarkMaps(other, map, {}).has_value();
  }
  EXPECT_EQ(matches, 0);
}

TEST(LandmarkMapMatching, RejectsSymmetricMatches) {
  const std::vector<Pose2> corners{{{0, 0}, 0}, {{10, 0}, M_PI_2}, {{10, 10}, M_PI}, {{0, 10}, -M_PI_2}};
  std::vector<MapPoint> map;
  for (const Pose2& corner : corners)
    for (const Vector2d& each : {Vector2d(0, 0), Vector2d(1, 0.3), Vector2d(0.4, 2), Vector2d(2.5, 2)}) {
      const Vector2d at = corner * each;
      map.push_back(point(at.x(), at.y(), "red", 0.01));
    }
  std::vector<MapPoint> local;
  for (size_t i = 4; i < 8; ++i) local.push_back(seenBy({{3, 1}, 0.4}, map[i]));
  EXPECT_FALSE(matchLandmarkMaps(local, map, {}));

  map[5].label.class_name = local[1].label.class_name = "blue";  // and with one that is not like the others
  expectPose(matchLandmarkMaps(local, map, {}), {{3, 1}, 0.4}, 1e-6, 1e-6);
}

TEST(LandmarkMapMatching, OneMarkerWithIdAndHeadingSuffices) {
  const std::vector<MapPoint> map{tag(3, 0, 0, 0.1), tag(4, 10, 2, 2.0), tag(5, 6, 9, -3.0)};
  const Pose2 truth{{4, 5}, 2.5};
  expectPose(matchLandmarkMaps({seenBy(truth, map[1])}, map, {}), truth, 1e-9, 1e-9);

  MapPoint without_id = seenBy(truth, map[1]), without_heading = without_id, unknown = without_id;
  without_id.label.id.reset();
  without_heading.landmark.heading.reset();
  unknown.label.id = 6;
  for (const MapPoint& each : {without_id, without_heading, unknown})
    EXPECT_FALSE(matchLandmarkMaps({each}, map, {}));
}

// Headings are less accurate than positions: the heading error of one marker displaces the other one.
TEST(LandmarkMapMatching, TwoMarkersAtOnePositionDoNotContradictEachOther) {
  const std::vector<MapPoint> map{tag(3, 0, 0, 0.1), tag(4, 8, 2, 2.0), tag(5, 6, 9, -3.0)};
  const Pose2 truth{{4, 5}, 2.5};
  for (const double off : {0.0, 0.02, 0.05, 0.1, 0.2}) {
    std::vector<MapPoint> local{seenBy(truth, map[0]), seenBy(truth, map[1])};
    *local[0].landmark.heading += off;
    expectPose(matchLandmarkMaps(local, map, {}), truth, 1e-6, 1e-6);
  }
}

TEST(LandmarkMapMatching, NeverPairsDifferentClasses) {
  std::mt19937 random(3);
  const std::vector<MapPoint> map = hall(random, 20);
  std::vector<MapPoint> local;
  for (size_t i = 0; i < 8; ++i) local.push_back(seenBy({{1, 2}, 1}, map[i]));
  const auto match = matchLandmarkMaps(local, map, {});
  ASSERT_TRUE(match);
  EXPECT_EQ(match->pairs.size(), 8u);
  for (MapPoint& each : local) each.label.class_name = "black";
  EXPECT_FALSE(matchLandmarkMaps(local, map, {}));
  local[0].label = map[0].label;
  EXPECT_FALSE(matchLandmarkMaps(local, map, {}));
}

TEST(LandmarkMapMatching, EmptyMapsHaveNoMatch) {
  EXPECT_FALSE(matchLandmarkMaps({}, {point(1, 2)}, {}));
  EXPECT_FALSE(matchLandmarkMaps({point(1, 2)}, {}, {}));
}

TEST(LandmarkMapMatching, NamesAFieldThatIsOutOfRange) {
  const std::vector<std::pair<std::string, double LandmarkMapMatchingParams::*>> fields{
      {"gate", &LandmarkMapMatchingParams::gate},
      {"min_probability", &LandmarkMapMatchingParams::min_probability},
      {"inlier_probability", &LandmarkMapMatchingParams::inlier_probability}};
  validate(LandmarkMapMatchingParams());
  for (const auto& [name, field] : fields)
    for (const double value : {0.0, 1.0, std::nan("")}) {
      LandmarkMapMatchingParams params;
      params.*field = value;
      EXPECT_EQ(refusal<std::invalid_argument>([&, &params = params] { validate(params); }).find(name), 0u);
    }
}

}  // namespace
}  // namespace sextant
