// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/landmark_session.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "sextant/markers/marker_map_file.hpp"
#include "test_observations.hpp"

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

TEST(LandmarkSession, AMapFileHasPriorityOverAMarkerMap) {
  const std::string path = ::testing::TempDir() + "landmark_session.yaml";
  LandmarkSlamNodeParams params;
  LandmarkSession session(params);
  LandmarkSession(params).save(path);
  const MarkerMap room = readMarkerMap(roomFile(), {});
  session.load(path);
  EXPECT_FALSE(session.setMarkerMap(room));
  EXPECT_TRUE(session.slam().labels().empty());
  session.reset();  // what was learnt is forgotten, where the markers are is not
  EXPECT_EQ(session.slam().labels().size(), room.markers().size());
  EXPECT_TRUE(session.setMarkerMap(room));
  std::filesystem::remove(path);
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
