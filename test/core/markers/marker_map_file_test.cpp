// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_map_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "test_marker_map.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

class MarkerMapFile : public testing::Test {
 protected:
  void SetUp() override {
    char pattern[] = "/tmp/sextant_map_XXXXXX";
    folder_ = mkdtemp(pattern);
  }
  void TearDown() override {
    for (const char* name : {"map.yaml", "map.yml", "map.txt"}) unlink(path(name).c_str());
    EXPECT_EQ(rmdir(folder_.c_str()), 0) << "a temporary file was left behind";
  }
  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  std::string folder_;
};

TEST_F(MarkerMapFile, ItsEndingTellsTheFormat) {
  MarkerMap map;
  map.add({{"tag36h11", 7}, 0.2, "7", poseFromXyzRpy({1, 2, 3}, {0, 0, 0}), Matrix6d::Zero()});
  for (const char* name : {"map.yaml", "map.yml", "map.txt"}) {
    writeMarkerMap(map, path(name));
    std::ifstream file(path(name));
    const std::string text(std::istreambuf_iterator<char>(file), {});
    EXPECT_EQ(text.find("\nmarkers:") != std::string::npos, std::string(name) != "map.txt");
    expectSameMap(readMarkerMap(path(name)), map);
  }
}

TEST_F(MarkerMapFile, ParsesContentAsIfItWasInTheFile) {
  const std::string line = "7 1 2 3 0 0 0\n";
  std::ofstream(path("map.txt")) << line;
  expectSameMap(parseMarkerMap(line, path("map.txt")), readMarkerMap(path("map.txt")));
  EXPECT_EQ(refusal<std::runtime_error>([] { parseMarkerMap("7 1 2 3 0 0 0 0.1\n", "hall.txt"); }),
            "hall.txt:1: has 8 fields, needs 'name Tx Ty Tz Rx Ry Rz'");
  EXPECT_EQ(parseMarkerMap("frame: hall\nmarkers: []\n", "hall.yaml").frame(), "hall");
}

TEST_F(MarkerMapFile, AMapThatItsFormatCannotHoldLeavesTheFileAsItWas) {
  std::ofstream(path("map.txt")) << "7 1 2 3 0 0 0\n";
  MarkerMap large;  // would come back with another size
  large.add({{"tag36h11", 7}, 0.3, "7", Pose::Identity(), Matrix6d::Zero()});
  EXPECT_THROW(writeMarkerMap(large, path("map.txt")), std::runtime_error);
  EXPECT_EQ(readMarkerMap(path("map.txt")).markers().size(), 1u);
  TextMapParams params;
  params.size = 0.3;
  EXPECT_NO_THROW(writeMarkerMap(large, path("map.txt"), params));
}

TEST_F(MarkerMapFile, NamesAFileThatCannotBeRead) {
  EXPECT_EQ(refusal<std::runtime_error>([&] { readMarkerMap(path("none.yaml")); }),
            path("none.yaml") + ": cannot be read: No such file or directory");
}

}  // namespace
}  // namespace sextant
