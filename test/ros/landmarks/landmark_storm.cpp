// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
// LandmarkSlam while everything that can be asked of it is asked at once.
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <std_srvs/Trigger.h>
#include <visualization_msgs/MarkerArray.h>

#include <atomic>
#include <limits>

#include "sextant/LandmarkMapFile.h"
#include "sextant/LandmarkObservations.h"
#include "sextant/MarkerMapEntries.h"
#include "storm.hpp"

namespace sextant {
namespace {

LandmarkObservations pillars() {
  LandmarkObservations msg;
  msg.header.frame_id = "base_link";
  for (const double y : {-0.8, 0.0, 1.0}) {
    LandmarkObservation pillar;
    pillar.class_name = "blue_pillar";
    pillar.id = -1;
    pillar.x = 2;
    pillar.y = y;
    pillar.heading = std::numeric_limits<double>::quiet_NaN();
    pillar.covariance = {1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 0};
    msg.observations.push_back(pillar);
  }
  return msg;
}

class LandmarkStorm : public Storm {
 protected:
  LandmarkStorm() : Storm(std::chrono::milliseconds(5), 200) {}

  void SetUp() override {
    Storm::SetUp();
    ros::param::set("/slam/map_file", (folder_ / "map.yaml").string());
    ros::param::set("/slam/tf_output", "map_to_odom");
    ros::param::set("/slam/cameras", std::vector<std::string>{"markers"});
    poses_sub_ = node_.subscribe("pose", 100, &LandmarkStorm::onPose, this);
    odometry_pub_ = node_.advertise<nav_msgs::Odometry>("odom", 100);
    observations_pub_ = node_.advertise<LandmarkObservations>("landmarks", 100);
    pictures_sub_ = node_.subscribe("landmark_map", 1, &LandmarkStorm::onPicture, this);
    places_pub_ = node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 1);
    maps_pub_ = node_.advertise<MarkerMapEntries>("marker_map/entries", 1);
    begin([this](const ros::Time& now, int number) { drive(now, number); });
  }
  void onPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& msg) {
    x_ = msg->pose.pose.position.x;
    ++poses_;
  }
  bool load() { return loader_.load("/slam", "sextant/LandmarkSlam", {}, {}); }
  bool awaitPoses(int more) {
    return await([this, wanted = poses_ + more] { return poses_ >= wanted; });
  }

  /// A robot that stands before three pillars.
  void drive(const ros::Time& now, int number) {
    nav_msgs::Odometry odometry;
    odometry.header.frame_id = "odom";
    odometry.child_frame_id = "base_link";
    odometry.pose.pose.orientation.w = 1;
    LandmarkObservations seen = pillars();
    odometry.header.stamp = seen.header.stamp = now;
    odometry_pub_.publish(odometry);
    if (number % 4 == 0) observations_pub_.publish(seen);
  }

  void rage() {
    repeat([this](int i) { ask(i); });
    repeat([this](int i) { useFiles(i); });
    repeat([this](int i) { tellPlaces(i); });
  }
  void ask(int i) {
    std_srvs::Trigger call;
    if (ros::service::call(i % 2 ? "/slam/reset" : "/slam/relocalize", call)) ++answers_;
    sleep(130);
  }
  void useFiles(int i) {
    LandmarkMapFile call;  // empty: ~map_file
    if (ros::service::call(i % 2 ? "/slam/load_map" : "/slam/save_map", call)) ++answers_;
    sleep(30);
  }
  void tellPlaces(int i) {
    sleep(200);
    geometry_msgs::PoseWithCovarianceStamped place;
    place.header.frame_id = "map";
    place.pose.pose.position.x = i % 5;
    place.pose.pose.orientation.w = i % 3 ? 1 : 0;  // every third one is refused
    for (const int k : {0, 7, 35}) place.pose.covariance[k] = 0.1;
    places_pub_.publish(place);
    MarkerMapEntries map;  // without markers
    map.header.frame_id = i % 2 ? "map" : "";
    maps_pub_.publish(map);
  }
  void onPicture(const visualization_msgs::MarkerArrayConstPtr&) { ++pictures_; }

  ros::Subscriber poses_sub_, pictures_sub_;
  ros::Publisher odometry_pub_, observations_pub_, places_pub_, maps_pub_;
  std::atomic<int> poses_{0}, answers_{0}, pictures_{0};
  std::atomic<double> x_{0};
};

TEST_F(LandmarkStorm, ContinuesAndIsCorrectAfterwards) {
  ASSERT_TRUE(load());
  ASSERT_TRUE(awaitPoses(1));
  rage();
  sleep(5000);
  EXPECT_TRUE(await([this] { return answers_ > 20 && pictures_ > 2; }))
      << answers_ << " answers, " << pictures_ << " pictures";
  calm();
  std_srvs::Trigger call;
  ASSERT_TRUE(ros::service::call("/slam/reset", call));
  EXPECT_TRUE(awaitPoses(20));
  EXPECT_NEAR(x_, 0.0, 0.03);
}

TEST_F(LandmarkStorm, IsUnloadedWhileRunning) {
  rage();
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(load());
    EXPECT_TRUE(await([this, wanted = answers_ + 2] { return answers_ >= wanted; }));
    EXPECT_TRUE(loader_.unload("/slam"));
  }
}

TEST_F(LandmarkStorm, IsUnloadedWhileStarting) {
  rage();
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(load());
    sleep(i / 3);
    EXPECT_TRUE(loader_.unload("/slam"));
  }
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) { return sextant::runStorms(argc, argv, "landmark_storm"); }
