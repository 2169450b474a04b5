// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "text_marker_map.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "test_marker_map.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

MarkerMap parsedText(const std::string& content, const TextMapParams& params = {}) {
  std::istringstream in(content);
  return parseTextMap(in, "map", params);
}

TEST(TextMarkerMap, ReadsEveryField) {
  TextMapParams params;
  params.family = "DICT_5X5_100";
  params.size = 0.12;
  params.sizes = {{12, 0.3}};
  params.parents = {{"camera", "base_link"}};
  const MarkerMap map = parsedText(
      "# hall\n7 1 2 3 0 0 0\n\n  Id8 1 2 3 0.1 0.2 0.3 # beside the door\ndoor_12 0 0 0 0 0 0\n"
      "camera 0 0 0.5 0 0 0\nshelf 1 0 0 0 0 0\n",
      params);
  EXPECT_EQ(map.markers().size(), 3u);
  EXPECT_EQ(map.find({"DICT_5X5_100", 7})->name, "7");
  EXPECT_TRUE(
      map.find({"DICT_5X5_100", 8})->T_map_marker.isApprox(poseFromXyzRpy({1, 2, 3}, {0.1, 0.2, 0.3})));
  EXPECT_EQ(map.find({"DICT_5X5_100", 8})->size, 0.12);
  EXPECT_EQ(map.find({"DICT_5X5_100", 12})->size, 0.3);
  ASSERT_EQ(map.frames().size(), 2u);
  EXPECT_EQ(map.frames()[0].parent, "base_link");
  EXPECT_EQ(map.frames()[1].parent, "map");
}

TEST(TextMarkerMap, NamesTheLineAndTheReasonOfAMistake) {
  const auto expectRefused = [](const std::string& content, int line, const std::string& part) {
    expectMistake(refusal<std::runtime_error>([&] { parsedText(content); }), line, part);
  };
  expectRefused("7 1 2 3 0 0 0\n8 1 2 3 0 0\n", 2, "has 6 fields");
  expectRefused("7 1 2 3 0 0 0 1\n", 1, "has 8 fields");
  expectRefused("map 0 0 0 0 0 0\n", 1, "frame of the map");
  expectRefused("7 1 2 3 0 0 0\nId7 1 2 3 0 0 0\n", 2, "listed twice");
  expectRefused("shelf 1 2 3 0 0 0\nshelf 1 2 3 0 0 0\n", 2, "used twice");
  expectRefused("7 1 2 x3 0 0 0\n", 1, "'x3' is not a number");
  expectRefused("7 1 2 nan 0 0 0\n", 1, "not finite");
  expectRefused("9999 1 2 3 0 0 0\n", 1, "ids of this family are 0 to 586");
  expectRefused("99999999999 1 2 3 0 0 0\n", 1, "too large");
}

TEST(TextMarkerMap, WritesWhatItReads) {
  const MarkerMap map =
      parsedText("7 1 2 3 0.1 0.2 0.3\ndoor_8 0.1 0.123456789012345 0 0 0 0\nshelf 1 0 0 0 0 0\n");
  expectSameMap(map, parsedText(formatTextMap(map, {})));
}

TEST(TextMarkerMap, RefusesWhatItCannotHold) {
  const MappedMarker plain{{"tag36h11", 7}, 0.2, "door_7", Pose::Identity(), Matrix6d::Zero()};
  const auto refused = [&](auto change, const std::string& frame = "map") {
    MappedMarker marker = plain;
    change(marker);
    MarkerMap map(frame);
    map.add(marker);
    const std::string text = refusal<std::runtime_error>([&] { formatTextMap(map, {}); });
    return text.substr(0, text.find("; write"));
  };
  const std::string cannot = "the plain text format cannot represent ";
  EXPECT_EQ(refused([](auto&) {}), "accepted");
  EXPECT_EQ(refused([](auto& m) { m.name = "door"; }),
            cannot + "marker 'door': its name does not end with its id");
  EXPECT_EQ(refused([](auto& m) { m.key.family = "tag16h5"; }),
            cannot + "marker 'door_7': it is of family tag16h5");
  EXPECT_EQ(refused([](auto& m) { m.size = 0.3; }), cannot + "marker 'door_7': its size is 0.3 m");
  EXPECT_EQ(refused([](auto& m) { m.covariance.setIdentity(); }),
            cannot + "marker 'door_7': it has a covariance");
  EXPECT_EQ(refused([](auto&) {}, "hall"), cannot + "the frame of the map: it is 'hall'");
  TextMapParams params;
  params.size = 0.3;
  MarkerMap large;
  large.add({{"tag36h11", 7}, 0.3, "7", Pose::Identity(), Matrix6d::Zero()});
  EXPECT_NO_THROW(formatTextMap(large, params));
}

}  // namespace
}  // namespace sextant
