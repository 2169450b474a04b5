// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_marker_map.hpp"

#include <gtest/gtest.h>

#include "test_marker_map.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

const char kYaml[] = R"(frame: hall
markers:
  - {family: tag36h11, id: 7, size: 0.2, name: Id7, position: [1, 2.5, -3], rpy: [0.1, -0.2, 3]}
  - family: DICT_APRILTAG_36h11
    id: 8
    size: 0.15
    position: [0, 0, 1]
    rpy: [1.5708, 0, 0]
    sigma_position: 0.01
    sigma_rotation: [0.02, 0.03, 0.04]
frames:
  - {name: dock, parent: hall, position: [1, 0, 0], rpy: [0, 0, 0]}
)";

TEST(YamlMarkerMap, ReadsEveryField) {
  const MarkerMap map = parseYamlMap(kYaml, "map");
  EXPECT_EQ(map.frame(), "hall");
  const MappedMarker* seven = map.find({"tag36h11", 7});
  ASSERT_TRUE(seven);
  EXPECT_EQ(seven->name, "Id7");
  EXPECT_TRUE(seven->T_map_marker.isApprox(poseFromXyzRpy({1, 2.5, -3}, {0.1, -0.2, 3})));
  const MappedMarker* eight = map.find({"tag36h11", 8});  // one print, one key
  ASSERT_TRUE(eight);
  EXPECT_EQ(eight->name, "tag36h11/8");
  EXPECT_NEAR(eight->covariance(1, 1), 1e-4, 1e-15);
  EXPECT_NEAR(eight->covariance(5, 5), 16e-4, 1e-15);
  ASSERT_EQ(map.frames().size(), 1u);
  EXPECT_EQ(map.frames()[0].name, "dock");
}

TEST(YamlMarkerMap, NamesTheLineAndTheReasonOfAMistake) {
  const auto expectRefused = [](const std::string& content, int line, const std::string& part) {
    expectMistake(refusal<std::runtime_error>([&] { parseYamlMap(content, "map"); }), line, part);
  };
  const std::string head = "frame: map\nmarkers:\n";
  const auto marker = [](const std::string& fields) { return "  - {family: tag36h11, " + fields + "}\n"; };
  const std::string pose = "position: [0, 0, 0], rpy: [0, 0, 0]";
  expectRefused(head + marker("id: 1, size: 0.2, rpy: [0, 0, 0]"), 3, "lacks 'position'");
  expectRefused(head + marker("id: 1, size: 0.2, colour: red, " + pose), 3, "unknown name 'colour'");
  expectRefused(head + marker("id: 1.5, size: 0.2, " + pose), 3, "whole number");
  expectRefused(head + marker("id: 1, size: -1, " + pose), 3, "size must be in");
  expectRefused(head + marker("id: 1, size: 0.2, position: [0, 0], rpy: [0, 0, 0]"), 3, "list of 3");
  expectRefused(head + marker("id: 1, size: .nan, " + pose), 3, "finite number");
  expectRefused(head + marker("id: 1, size: 0.2, " + pose) + marker("id: 1, size: 0.2, " + pose), 4,
                "listed twice");
  expectRefused(head + "  - {family: tag99, id: 1, size: 0.2, " + pose + "}\n", 3, "unknown marker family");
  expectRefused(head + marker("id: 1, size: 0.2, sigma_position: -1, " + pose), 3, "cannot be negative");
  expectRefused("frame: map\nframe: map\nmarkers: []\n", 2, "given twice");
  expectRefused("frame: map\n", 1, "lacks 'markers'");
  expectRefused("frame: [\n", 2, "");
  expectRefused("", 1, "must be a table");
}

TEST(YamlMarkerMap, WritesWhatItReads) {
  const MarkerMap map = parseYamlMap(kYaml, "map");
  expectSameMap(map, parseYamlMap(formatYamlMap(map), "map"));
  const MarkerMap empty("hall \"7\"");
  expectSameMap(empty, parseYamlMap(formatYamlMap(empty), "map"));
}

TEST(YamlMarkerMap, ACovarianceIsGivenInOneWay) {
  std::string ones = "1";
  for (int i = 1; i < 36; ++i) ones += ", 1";
  const auto read = [&](const std::string& more) {
    return refusal<std::runtime_error>([&] {
      parseYamlMap(
          "frame: map\nmarkers:\n- {family: tag36h11, id: 1, size: 1, position: [0, 0, 0], rpy: [0, 0, 0], " +
              more + "covariance: [" + ones + "]}",
          "map");
    });
  };
  EXPECT_EQ(read(""), "accepted");
  EXPECT_EQ(read("sigma_position: 1, "),
            "map:3: covariance cannot be combined with sigma_position or sigma_rotation");
}

}  // namespace
}  // namespace sextant
