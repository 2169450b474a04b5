// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/landmark_session.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "sextant/markers/marker_map_file.hpp"
#include "test_observations.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

/// A file of one marker on the wall.
std::string roomFile() {
  const std::string path = ::testing::TempDir() + "landmark_session_room.yaml";
  MarkerMap room("room");
  room.add({{"tag36h11", 7}, 0.2, "", markerOnWall({3, 1, 1}, 0.7), Matrix6d::Zero()});
  writeMarkerMap(room, path);
  return path;
}

/// A landmark map of one pillar and of the marker of roomFile(), half a metre from where that has it.
std::string pillarFile(const std::string& frame) {
  const std::string path = ::testing::TempDir() + "landmark_session.yaml";
  const LandmarkMap map{frame,
                        {{1, 0}, 0},
                        {{{4, 2}, {}}, {{3.5, 1}, {0.7}}},
                        {{"pillar", {}}, {"tag36h11", 7}},
                        0.01 * Eigen::MatrixXd::Identity(8, 8)};
  writeLandmarkMap(map, path);
  return path;
}

TEST(LandmarkSession, MarkersAreAddedToALandmarkMap) {
  LandmarkSlamNodeParams params;
  params.map_file = pillarFile("room");
  params.start = "map";
  MarkerMap room = readMarkerMap(roomFile(), {});
  room.add({{"tag36h11", 8}, 0.2, "", markerOnWall({0, 5, 1}, 0.2), 1e-6 * Matrix6d::Identity()});
  LandmarkSession by_topic(params);
  by_topic.setMarkerMap(room);
  params.marker_map_file = ::testing::TempDir() + "landmark_session_markers.yaml";
  writeMarkerMap(room, params.marker_map_file);
  const LandmarkSession by_file(params);
  for (const LandmarkSession* each : std::initializer_list<const LandmarkSession*>{&by_topic, &by_file}) {
    const LandmarkMap made = each->map();
    ASSERT_EQ(made.labels.size(), 3u);
    EXPECT_EQ(made.labels[2], (LandmarkLabel{"tag36h11", 8}));
    EXPECT_LT((made.landmarks[1].position - Eigen::Vector2d(3.5, 1)).norm(), 1e-9);  // as it was mapped
    EXPECT_LT((made.landmarks[2].position - Eigen::Vector2d(0, 5)).norm(), 1e-9);
    EXPECT_NEAR(made.covariance(8, 8), 1e-6, 2e-8);
    EXPECT_EQ(made.T_map_base.position, Eigen::Vector2d(1, 0));
  }
  std::filesystem::remove(params.map_file);
  std::filesystem::remove(params.marker_map_file);
}

TEST(LandmarkSession, MapsOfTwoFramesAreRefused) {
  LandmarkSlamNodeParams params;
  params.map_file = pillarFile("hall");
  LandmarkSession session(params);
  const MarkerMap room = readMarkerMap(roomFile(), {});
  EXPECT_NE(refusal<std::invalid_argument>([&] { session.setMarkerMap(room); }).find("is 'room'"),
            std::string::npos);
  EXPECT_EQ(session.slam().labels().size(), 2u);
  session.load("");  // the refused map is forgotten
  params.marker_map_file = roomFile();
  EXPECT_NE(refusal<std::invalid_argument>([&] { const LandmarkSession made(params); }).find("must be equal"),
            std::string::npos);
  std::filesystem::remove(params.map_file);
}

TEST(LandmarkSession, ARobotWithPlacesOnlyIsLostUntilOneIsRecognized) {
  LandmarkSlamNodeParams params;
  params.places = "places/hypotheses";
  EXPECT_FALSE(LandmarkSession(params).slam().isLost());
  params.start = "unknown";
  LandmarkSession session(params);
  EXPECT_TRUE(session.slam().isLost());
  EXPECT_EQ(session.emptyMapReason(), "");
  session.timeline().odometry(1.0, {});
  session.timeline().observePlaces(1.0, {{{{5, 2}, 1}, 0.01 * Eigen::Matrix3d::Identity(), 0.9}});
  EXPECT_FALSE(session.slam().isLost());
  EXPECT_LT((session.slam().filter().pose().position - Eigen::Vector2d(5, 2)).norm(), 1e-9);
  session.relocalize();
  EXPECT_TRUE(session.slam().isLost());
}

TEST(LandmarkSession, ALostRobotIsLostInTheFile) {
  const std::string path = ::testing::TempDir() + "landmark_session.yaml";
  LandmarkSlamNodeParams params;
  params.marker_map_file = roomFile();
  params.start = "map";
  LandmarkSession session(params);
  for (const bool is_lost : {false, true}) {
    session.setPose({{{1, 2}, 0.5}, 0.01 * Eigen::Matrix3d::Identity()});
    if (is_lost) session.relocalize();
    session.save(path);
    session.setPose({{{0, 0}, 0}, 0.01 * Eigen::Matrix3d::Identity()});
    session.load(path);
    EXPECT_EQ(session.slam().isLost(), is_lost);
    EXPECT_EQ(session.slam().filter().pose().heading, 0.5);
  }
  std::filesystem::remove(path);
}

TEST(LandmarkSession, ReportsWhyTheMapIsEmpty) {
  LandmarkSlamNodeParams params;
  params.map_file = "/nowhere/hall.yaml";
  EXPECT_EQ(LandmarkSession(params).emptyMapReason(), "");  // it will be created
  params.start = "unknown";
  EXPECT_EQ(LandmarkSession(params).emptyMapReason(),
            "start is 'unknown', but /nowhere/hall.yaml does not exist or is empty: the map is empty, and "
            "the robot "
            "is at ~start_pose");
  params.cameras = {"markers"};
  EXPECT_EQ(LandmarkSession(params).emptyMapReason(), "");  // their map may be received
  params = {};
  params.slam.read_only = true;
  EXPECT_EQ(LandmarkSession(params).emptyMapReason().find("read_only is true, but ~map_file is not set"), 0u);
  params.marker_map_file = roomFile();
  EXPECT_EQ(LandmarkSession(params).emptyMapReason(), "");
}

}  // namespace
}  // namespace sextant
