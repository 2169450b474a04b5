// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_map_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::MatrixXd;

class LandmarkMapFile : public testing::Test {
 protected:
  void SetUp() override {
    char pattern[] = "/tmp/sextant_landmarks_XXXXXX";
    folder_ = mkdtemp(pattern);
  }
  void TearDown() override {
    unlink(path().c_str());
    EXPECT_EQ(rmdir(folder_.c_str()), 0) << "a temporary file was left behind";
  }
  std::string path() const { return folder_ + "/map.yaml"; }

  LandmarkMap read(const std::string& content) const {
    std::ofstream(path()) << content;
    return readLandmarkMap(path());
  }

  void expectRefused(const std::string& content, int line, const std::string& part) const {
    const std::string text = refusal<std::runtime_error>([&] { read(content); });
    EXPECT_EQ(text.find(path() + ":" + std::to_string(line) + ": "), 0u) << text << "\nof\n" << content;
    EXPECT_NE(text.find(part), std::string::npos) << text << "\nof\n" << content;
  }

  std::string folder_;
};

MatrixXd covarianceOf(int size) {
  srand(size);
  const MatrixXd A = MatrixXd::Random(size, size) / 3;
  return (A * A.transpose()).eval().selfadjointView<Eigen::Lower>();
}

LandmarkMap mapOf(const std::vector<std::string>& classes) {
  LandmarkMap map;
  map.frame = "hall \"A\": 1";
  map.T_map_base = {{1.0 / 3, -2e-7}, 3.1};
  for (size_t i = 0; i < classes.size(); ++i) {
    map.landmarks.push_back({{0.1 * i + 1e6, -1.0 / (i + 7)}, {}});
    map.labels.push_back({classes[i], {}});
    if (i % 2 == 0) map.landmarks.back().heading = 0.1 + i;
    if (i % 3 != 0) map.labels.back().id = static_cast<int>(100 * i);
  }
  map.covariance = covarianceOf(static_cast<int>(3 + 2 * classes.size() + (classes.size() + 1) / 2));
  return map;
}

void expectSame(const LandmarkMap& a, const LandmarkMap& b) {
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.T_map_base.position, b.T_map_base.position);
  EXPECT_EQ(a.T_map_base.heading, b.T_map_base.heading);
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_EQ(a.covariance, b.covariance);
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  for (size_t i = 0; i < a.landmarks.size(); ++i) {
    EXPECT_EQ(a.landmarks[i].position, b.landmarks[i].position);
    EXPECT_EQ(a.landmarks[i].heading, b.landmarks[i].heading);
  }
}

TEST_F(LandmarkMapFile, WritesWhatItReadsToTheLastBit) {
  for (const auto& classes :
       {std::vector<std::string>{},
        {"blue_pillar"},
        {"tag36h11", "tag36h11", "tag36h11"},
        {"red: {pillar}, #2", "\"quoted\"", "two\nlines\t", "Säule", "7", "true", "~", "[", " \\ "}}) {
    const LandmarkMap map = mapOf(classes);
    writeLandmarkMap(map, path());
    expectSame(map, readLandmarkMap(path()));
  }
}

TEST_F(LandmarkMapFile, SavesThatTheRobotIsLost) {
  LandmarkMap map = mapOf({"blue_pillar"});
  writeLandmarkMap(map, path());
  EXPECT_FALSE(readLandmarkMap(path()).is_lost);
  map.is_lost = true;
  writeLandmarkMap(map, path());
  EXPECT_TRUE(readLandmarkMap(path()).is_lost);
}

const char kHead[] = "frame: map\nrobot: [1, 2, 0.5]\n";
const char kRobot[] = "  - [0.1]\n  - [0, 0.1]\n  - [0, 0, 0.1]\n";
const std::string kOne = "landmarks:\n  - {class: red, position: [3, 4]}\n";
const std::string kRows =
    std::string("covariance:\n") + kRobot + "  - [0, 0, 0, 0.2]\n  - [0, 0, 0, 0.1, 0.2]\n";

TEST_F(LandmarkMapFile, ReadsYaml) {
  const LandmarkMap map = read(kHead + kOne + kRows);
  EXPECT_EQ(map.frame, "map");
  EXPECT_EQ(map.T_map_base.heading, 0.5);
  EXPECT_EQ(map.landmarks.at(0).position, Eigen::Vector2d(3, 4));
  EXPECT_FALSE(map.landmarks[0].heading);
  EXPECT_EQ(map.labels.at(0), (LandmarkLabel{"red", {}}));
  EXPECT_EQ(map.covariance(3, 4), 0.1);
}

TEST_F(LandmarkMapFile, RefusesErrorsOfTheTableWithLineAndReason) {
  const struct {
    std::string content;
    int line;
    std::string part;
  } mistakes[] = {{"", 1, "must be a table"},
                  {"- 1\n", 1, "must be a table"},
                  {"frame: [\n", 2, ""},
                  {"frame: map\nframe: map\n", 2, "'frame' is given twice"},
                  {kHead + kOne, 1, "lacks 'covariance'"},
                  {kHead + kOne + kRows + "colour: red\n", 11, "unknown name 'colour'"},
                  {"frame: \"\"\nrobot: [1, 2, 3]\n" + kOne + kRows, 1, "needs a text that is not empty"},
                  {"frame: map\nrobot: [1, 2]\n" + kOne + kRows, 2, "list of 3"},
                  {"frame: map\nrobot: [1, 2, x]\n" + kOne + kRows, 2, "finite number, not 'x'"},
                  {kHead + std::string("lost: perhaps\n") + kOne + kRows, 3, "true or false"},
                  {"frame: map\nrobot: [1, .inf, 0]\n" + kOne + kRows, 2, "finite number"},
                  {std::string(kHead) + "landmarks: 3\n" + kRows, 3, "must be a list"}};
  for (const auto& each : mistakes) expectRefused(each.content, each.line, each.part);
}

TEST_F(LandmarkMapFile, RefusesErrorsOfALandmarkWithLineAndReason) {
  const std::pair<std::string, std::string> mistakes[] = {
      {"red", "must be a table"},
      {"{position: [3, 4]}", "lacks 'class'"},
      {"{class: red}", "lacks 'position'"},
      {"{class: [red], position: [3, 4]}", "needs a text that is not empty"},
      {"{class: red, position: [3, 4], size: 2}", "unknown name 'size'"},
      {"{class: red, position: [3, 4, 5]}", "list of 2"},
      {"{class: red, position: [3, .nan]}", "finite number"},
      {"{class: red, position: [3, 4], heading: north}", "finite number, not 'north'"},
      {"{class: red, position: [3, 4], heading: }", "finite number"},
      {"{class: red, id: 1.5, position: [3, 4]}", "whole number"},
      {"{class: red, id: 99999999999, position: [3, 4]}", "whole number"}};
  for (const auto& [landmark, part] : mistakes)
    expectRefused(std::string(kHead) + "landmarks:\n  - " + landmark + "\n" + kRows, 4, part);
  const std::string seven = "  - {class: tag, id: 7, position: [0, 0]}\n";
  expectRefused(std::string(kHead) + "landmarks:\n" + seven + seven + kRows, 5, "occurs twice");
}

TEST_F(LandmarkMapFile, RefusesErrorsOfTheCovarianceWithLineAndReason) {
  const std::string start = kHead + kOne + "covariance:\n";
  const std::string rows = start + kRobot;
  expectRefused(kHead + kOne + "covariance: 3\n", 5, "needs 5 rows");
  expectRefused(rows, 6, "needs 5 rows");
  expectRefused(kHead + kOne + kRows + "  - [0, 0, 0, 0, 0, 0.1]\n", 6, "needs 5 rows");
  expectRefused(rows + "  - [0, 0, 0, 0.2]\n  - [0, 0, 0, 0.2]\n", 10, "list of 5");
  expectRefused(rows + "  - [0, 0, 0, 0.2, 0]\n  - [0, 0, 0, 0, 0.2]\n", 9, "list of 4");
  expectRefused(rows + "  - [0, 0, .nan, 0.2]\n  - [0, 0, 0, 0, 0.2]\n", 9, "finite number");
  expectRefused(rows + "  - [0, 0, 0, 0.2]\n  - [0, 0, 0, 0.3, 0.2]\n", 6, "negative eigenvalue");
}

TEST_F(LandmarkMapFile, NamesFilesThatCannotBeReadOrWritten) {
  for (const std::string& none : {path(), folder_})
    EXPECT_EQ(refusal<std::runtime_error>([&] { readLandmarkMap(none); }).find(none + ": cannot be read: "),
              0u);
  const std::string nowhere = folder_ + "/no/such/map.yaml";
  const std::string text = refusal<std::runtime_error>([&] { writeLandmarkMap(mapOf({"red"}), nowhere); });
  EXPECT_NE(text.find(nowhere), std::string::npos) << text;
}

TEST_F(LandmarkMapFile, WritesNoInvalidMap) {
  const std::pair<std::string, std::function<void(LandmarkMap&)>> mistakes[] = {
      {"needs a label", [](LandmarkMap& map) { map.labels.pop_back(); }},
      {"needs 13 rows", [](LandmarkMap& map) { map.covariance = covarianceOf(12); }},
      {"not finite", [](LandmarkMap& map) { map.covariance(3, 3) = std::nan(""); }},
      {"not finite", [](LandmarkMap& map) { map.landmarks[1].position.y() = std::nan(""); }},
      {"not finite", [](LandmarkMap& map) { map.landmarks[0].heading = INFINITY; }},
      {"not finite", [](LandmarkMap& map) { map.T_map_base.heading = INFINITY; }},
      {"negative eigenvalue", [](LandmarkMap& map) { map.covariance(3, 3) -= 100; }},
      {"occurs twice", [](LandmarkMap& map) { map.labels[0] = map.labels[1]; }},
      {"a name", [](LandmarkMap& map) { map.labels[0].class_name.clear(); }},
      {"a name", [](LandmarkMap& map) { map.frame.clear(); }}};
  LandmarkMap good = mapOf({"red", "red", "red", "blue"});
  writeLandmarkMap(good, path());
  for (const auto& [part, spoil] : mistakes) {
    LandmarkMap map = good;
    spoil(map);
    const std::string text =
        refusal<std::invalid_argument>([&, &map = map] { writeLandmarkMap(map, path()); });
    EXPECT_NE(text.find(part), std::string::npos) << text << ", not " << part;
  }
  expectSame(good, readLandmarkMap(path()));  // what was there is still there
}

}  // namespace
}  // namespace sextant
