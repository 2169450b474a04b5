// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/landmarks/landmark_session.hpp"

#include <gtest/gtest.h>
#include <ros/package.h>

#include <filesystem>

#include "sextant/markers/marker_map_file.hpp"

namespace sextant {
namespace {

TEST(LandmarkSession, AMapFileStaysWhereMarkersAreTold) {
  const std::string path = ::testing::TempDir() + "landmark_session.yaml";
  LandmarkSlamNodeParams params;
  LandmarkSession session(params);
  LandmarkSession(params).save(path);
  const MarkerMap room = readMarkerMap(ros::package::getPath("sextant") + "/config/room.txt", {});
  session.load(path);
  EXPECT_FALSE(session.takeMarkers(room));
  EXPECT_TRUE(session.slam().labels().empty());
  session.reset();  // what was learnt is forgotten, where the markers are is not
  EXPECT_EQ(session.slam().labels().size(), room.markers().size());
  EXPECT_TRUE(session.takeMarkers(room));
  std::filesystem::remove(path);
}

TEST(LandmarkSession, ALostRobotIsLostInTheFile) {
  const std::string path = ::testing::TempDir() + "landmark_session.yaml";
  LandmarkSlamNodeParams params;
  params.marker_map_file = ros::package::getPath("sextant") + "/config/room.txt";
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

TEST(LandmarkSession, SaysThatTheMapIsNotThere) {
  LandmarkSlamNodeParams params;
  params.map_file = "/nowhere/hall.yaml";
  EXPECT_EQ(LandmarkSession(params).whyEmpty(), "");  // it will be made
  params.start = "unknown";
  EXPECT_EQ(LandmarkSession(params).whyEmpty(),
            "start is 'unknown', but there is nothing in /nowhere/hall.yaml: the map is empty, and the robot "
            "at ~start_pose");
  params.cameras = {"markers"};
  EXPECT_EQ(LandmarkSession(params).whyEmpty(), "");  // their map may come
  params = {};
  params.slam.read_only = true;
  EXPECT_EQ(LandmarkSession(params).whyEmpty().find("read_only is true, but there is no ~map_file"), 0u);
  params.marker_map_file = ros::package::getPath("sextant") + "/config/room.txt";
  EXPECT_EQ(LandmarkSession(params).whyEmpty(), "");
}

}  // namespace
}  // namespace sextant
