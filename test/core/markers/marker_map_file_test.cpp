// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_map_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace sextant {
namespace {

class MarkerMapFile : public testing::Test {
 protected:
  void SetUp() override {
    char pattern[] = "/tmp/sextant_map_XXXXXX";
    folder_ = mkdtemp(pattern);
  }
  void TearDown() override {
    for (const char* name : {"map.yaml", "map.txt"}) unlink(path(name).c_str());
    EXPECT_EQ(rmdir(folder_.c_str()), 0) << "a temporary file was left behind";
  }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  MarkerMap read(const std::string& name, const std::string& content,
                 const TextMapParams& params = {}) const {
    std::ofstream(path(name)) << content;
    return readMarkerMap(path(name), params);
  }

  void expectRefused(const std::string& name, const std::string& content, int line,
                     const std::string& part) const {
    try {
      read(name, content);
      FAIL() << "accepted: " << content;
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find(path(name) + ":" + std::to_string(line) + ": "), 0u) << text;
      EXPECT_NE(text.find(part), std::string::npos) << text;
    }
  }

  std::string folder_;
};

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

TEST_F(MarkerMapFile, ReadsYaml) {
  const MarkerMap map = read("map.yaml", kYaml);
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

TEST_F(MarkerMapFile, ReadsTheTextFormat) {
  TextMapParams params;
  params.family = "DICT_5X5_100";
  params.size = 0.12;
  params.sizes = {{12, 0.3}};
  params.parents = {{"camera", "base_link"}};
  const MarkerMap map =
      read("map.txt",
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

TEST_F(MarkerMapFile, RefusesBadTextWithLineAndReason) {
  expectRefused("map.txt", "7 1 2 3 0 0 0\n8 1 2 3 0 0\n", 2, "has 6 fields");
  expectRefused("map.txt", "7 1 2 3 0 0 0 1\n", 1, "has 8 fields");
  expectRefused("map.txt", "map 0 0 0 0 0 0\n", 1, "map's own frame");
  expectRefused("map.txt", "7 1 2 3 0 0 0\nId7 1 2 3 0 0 0\n", 2, "there twice");
  expectRefused("map.txt", "shelf 1 2 3 0 0 0\nshelf 1 2 3 0 0 0\n", 2, "there twice");
  expectRefused("map.txt", "7 1 2 x3 0 0 0\n", 1, "'x3' is not a number");
  expectRefused("map.txt", "7 1 2 nan 0 0 0\n", 1, "not finite");
  expectRefused("map.txt", "9999 1 2 3 0 0 0\n", 1, "ids are 0 to 586");
  expectRefused("map.txt", "99999999999 1 2 3 0 0 0\n", 1, "too large");
}

TEST_F(MarkerMapFile, RefusesBadYamlWithLineAndReason) {
  const std::string head = "frame: map\nmarkers:\n";
  const auto marker = [](const std::string& fields) { return "  - {family: tag36h11, " + fields + "}\n"; };
  const std::string pose = "position: [0, 0, 0], rpy: [0, 0, 0]";
  expectRefused("map.yaml", head + marker("id: 1, size: 0.2, rpy: [0, 0, 0]"), 3, "lacks 'position'");
  expectRefused("map.yaml", head + marker("id: 1, size: 0.2, colour: red, " + pose), 3,
                "unknown name 'colour'");
  expectRefused("map.yaml", head + marker("id: 1.5, size: 0.2, " + pose), 3, "whole number");
  expectRefused("map.yaml", head + marker("id: 1, size: -1, " + pose), 3, "size must be in");
  expectRefused("map.yaml", head + marker("id: 1, size: 0.2, position: [0, 0], rpy: [0, 0, 0]"), 3,
                "list of 3");
  expectRefused("map.yaml", head + marker("id: 1, size: .nan, " + pose), 3, "finite number");
  expectRefused("map.yaml", head + marker("id: 1, size: 0.2, " + pose) + marker("id: 1, size: 0.2, " + pose),
                4, "there twice");
  expectRefused("map.yaml", head + "  - {family: tag99, id: 1, size: 0.2, " + pose + "}\n", 3,
                "unknown marker family");
  expectRefused("map.yaml", head + marker("id: 1, size: 0.2, sigma_position: -1, " + pose), 3,
                "cannot be negative");
  expectRefused("map.yaml", "frame: map\nframe: map\nmarkers: []\n", 2, "there twice");
  expectRefused("map.yaml", "frame: map\n", 1, "lacks 'markers'");
  expectRefused("map.yaml", "frame: [\n", 2, "");
  expectRefused("map.yaml", "", 1, "must be a table");
}

TEST_F(MarkerMapFile, NamesAFileThatIsNotThere) {
  try {
    readMarkerMap(path("none.yaml"));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("none.yaml: cannot be read"), std::string::npos);
  }
}

void expectSame(const MarkerMap& a, const MarkerMap& b) {
  EXPECT_EQ(a.frame(), b.frame());
  ASSERT_EQ(a.markers().size(), b.markers().size());
  for (const auto& [key, marker] : a.markers()) {
    const MappedMarker* other = b.find(key);
    ASSERT_TRUE(other);
    EXPECT_EQ(marker.name, other->name);
    EXPECT_EQ(marker.size, other->size);
    EXPECT_EQ(marker.covariance, other->covariance);
    EXPECT_TRUE(marker.T_map_marker.isApprox(other->T_map_marker, 1e-14));
  }
  ASSERT_EQ(a.frames().size(), b.frames().size());
  for (size_t i = 0; i < a.frames().size(); ++i) EXPECT_EQ(a.frames()[i].parent, b.frames()[i].parent);
}

TEST_F(MarkerMapFile, WritesWhatItReads) {
  const MarkerMap map = read("map.yaml", kYaml);
  writeMarkerMap(map, path("map.yaml"));
  expectSame(map, readMarkerMap(path("map.yaml")));
  const MarkerMap text =
      read("map.txt", "7 1 2 3 0.1 0.2 0.3\ndoor_8 0.1 0.123456789012345 0 0 0 0\nshelf 1 0 0 0 0 0\n");
  writeMarkerMap(text, path("map.txt"));
  expectSame(text, readMarkerMap(path("map.txt")));
}

TEST_F(MarkerMapFile, TextFormatRefusesWhatItCannotHold) {
  const MarkerMap map = read("map.yaml", kYaml);
  std::ofstream(path("map.txt")) << "7 1 2 3 0 0 0\n";
  EXPECT_THROW(writeMarkerMap(map, path("map.txt")), std::runtime_error);
  EXPECT_EQ(readMarkerMap(path("map.txt")).markers().size(), 1u);  // what was there is still there
  MarkerMap large;                                                 // would come back with another size
  large.add({{"tag36h11", 7}, 0.3, "7", Pose::Identity(), Matrix6d::Zero()});
  EXPECT_THROW(writeMarkerMap(large, path("map.txt")), std::runtime_error);
  TextMapParams params;
  params.size = 0.3;
  EXPECT_NO_THROW(writeMarkerMap(large, path("map.txt"), params));
}

TEST_F(MarkerMapFile, KeepsTheFilesModeAndFailsLoudly) {
  const MarkerMap map = read("map.yaml", kYaml);
  chmod(path("map.yaml").c_str(), 0640);
  writeMarkerMap(map, path("map.yaml"));
  struct stat status {};
  stat(path("map.yaml").c_str(), &status);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
  EXPECT_THROW(writeMarkerMap(map, path("no/such/folder/map.yaml")), std::runtime_error);
}

}  // namespace
}  // namespace sextant
