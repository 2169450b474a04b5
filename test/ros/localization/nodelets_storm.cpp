// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
// The nodelets of printed markers while everything changes at once.
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <ros/package.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/String.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/transform_broadcaster.h>
#include <visualization_msgs/MarkerArray.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <mutex>
#include <opencv2/imgcodecs.hpp>

#include "sextant/MarkerArray.h"
#include "sextant/MarkerMapEntries.h"
#include "sextant/markers/marker_map_file.hpp"
#include "sextant/ros/base/start_in_queue.hpp"
#include "sextant/ros/base/subscription_lock.hpp"
#include "sextant/ros/markers/marker_conversions.hpp"
#include "sextant/simulation/room_renderer.hpp"
#include "storm.hpp"

namespace sextant {
namespace {

CameraModel camera() {
  CameraCalibration calibration;
  calibration.width = 640;
  calibration.height = 480;
  calibration.distortion_model = "plumb_bob";
  calibration.D.assign(5, 0.0);
  calibration.K << 500, 0, 319.5, 0, 500, 239.5, 0, 0, 1;
  return CameraModel(calibration, CameraModel::Image::raw);
}

sensor_msgs::CameraInfo info() {
  sensor_msgs::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {500, 0, 319.5, 0, 500, 239.5, 0, 0, 1};
  return info;
}

class NodeletsStorm : public Storm {
 protected:
  NodeletsStorm() : Storm(std::chrono::milliseconds(20), 50) {}

  void SetUp() override {
    Storm::SetUp();
    const std::string room = ros::package::getPath("sextant") + "/config/room.txt";
    map_ = readMarkerMap(room, TextMapParams());
    auto scene = std::make_shared<RoomScene>(RoomSceneParams(), map_);
    picture_ = RoomRenderer(RoomRendererParams(), scene, camera()).render({T_map_camera_}, 0);
    ASSERT_TRUE(cv::imwrite(folder_ / "0.png", picture_));
    ros::param::set("/driver/source", folder_.string());
    ros::param::set("/driver/encoding", "mono8");
    ros::param::set("/driver/rate", 50);
    ros::param::set("/driver/loop", true);
    ros::param::set("/locator/map_file", room);
    ros::param::set("/locator/tf_output", "map_to_base");
    poses_sub_ = node_.subscribe("pose", 100, &NodeletsStorm::onPose, this);
    info_pub_ = node_.advertise<sensor_msgs::CameraInfo>("/image/camera_info", 1, true);
    info_pub_.publish(info());
    map_pub_ = node_.advertise<MarkerMapEntries>("marker_map/entries", 1);
    geometry_msgs::TransformStamped mount;
    mount.header.frame_id = "base_link";
    mount.child_frame_id = "camera_optical_frame";
    mount.transform = toTransformMsg(Pose::Identity());
    begin([this, mount](const ros::Time& now, int) mutable {
      mount.header.stamp = now;
      broadcaster_.sendTransform(mount);
    });
  }
  void load() {
    ASSERT_TRUE(loader_.load("/driver", "sextant/CameraDriver", {}, {}));
    const nodelet::M_string remappings = {{"/image", "/image_raw"}, {"/camera_info", "/image/camera_info"}};
    ASSERT_TRUE(loader_.load("/detector", "sextant/MarkerDetector", remappings, {}));
    ASSERT_TRUE(loader_.load("/locator", "sextant/MarkerLocator", {}, {}));
  }

  void onPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& msg) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++poses_;
    if ((msg->header.stamp - stamp_).toSec() < -kJump / 2) ++jumps_;
    stamp_ = msg->header.stamp;
    const auto& p = msg->pose.pose.position;
    position_ = {p.x, p.y, p.z};
  }
  int poses() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return poses_;
  }
  // Of everything that the storm is made of.
  bool sawEnough() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return accepted_ > 10 && pictures_ > 2 && boards_ > 2 && jumps_ > 0;
  }
  bool awaitPoses(int more) {
    return await([this, wanted = poses() + more] { return poses() >= wanted; });
  }

  void rage() {
    repeat([this](int i) { reconfigureDetector(i); });
    repeat([this](int i) { reconfigureLocator(i); });
    repeat([this](int i) { lookAtPictures(i); });
    repeat([this](int i) { switchOffAndOn(i); });
    repeat([this](int i) { recalibrate(i); });
    repeat([this](int i) { changeMap(i); });
  }
  void reconfigureDetector(int i) {
    dynamic_reconfigure::Reconfigure call;
    call.request.config.doubles.resize(1);
    call.request.config.doubles[0].name = "decimate";
    call.request.config.doubles[0].value = i % 3 == 2 ? 99.0 : 1.0 + i % 3;  // every third one is refused
    if (ros::service::call("/detector/set_parameters", call)) ++accepted_;
  }
  void reconfigureLocator(int i) {
    dynamic_reconfigure::Reconfigure call;
    call.request.config.strs.resize(1);
    call.request.config.strs[0].name = "mode";
    call.request.config.strs[0].value = i % 2 ? "nearest" : "joint";
    if (ros::service::call("/locator/set_parameters", call)) ++accepted_;
  }
  void lookAtPictures(int) {
    const auto raw =
        node_.subscribe<sensor_msgs::Image>("markers/image", 1, [this](const auto&) { ++pictures_; });
    const auto jpeg = node_.subscribe<sensor_msgs::CompressedImage>("markers/image/compressed", 1,
                                                                    [this](const auto&) { ++pictures_; });
    const auto boards = node_.subscribe<visualization_msgs::MarkerArray>("visualization", 1,
                                                                         [this](const auto&) { ++boards_; });
    sleep(200);
  }
  void switchOffAndOn(int) {
    std_srvs::SetBool call;
    for (const bool on : {false, true}) {
      call.request.data = on;
      ros::service::call("/detector/enable", call);
      sleep(300);
    }
  }
  void recalibrate(int i) {
    sensor_msgs::CameraInfo changed = info();
    changed.K[0] = i % 2 ? 500.0 : 0.0;  // without a focal length: no calibration
    info_pub_.publish(changed);
    sleep(100);
  }

  void changeMap(int i) {
    MarkerMapEntries changed = map(map_);
    if (i % 3 == 1) changed.markers.resize(changed.markers.size() / 2);
    if (i % 3 == 2) changed.markers.front().size = -1.0;  // is refused
    map_pub_.publish(changed);
    sleep(150);
  }
  static MarkerMapEntries map(const MarkerMap& map) {
    MarkerMapEntries msg;
    msg.header.frame_id = map.frame();
    for (const auto& marker : map.markers()) msg.markers.push_back(toMsg(marker.second));
    return msg;
  }

  const Pose T_map_camera_ = poseFromXyzRpy({0, 0, 1}, {-M_PI / 2, 0, 0});  // looks along y
  MarkerMap map_;
  cv::Mat picture_;
  ros::Subscriber poses_sub_;
  ros::Publisher info_pub_, map_pub_;
  std::mutex mutex_;  // of these
  int poses_ = 0, jumps_ = 0;
  ros::Time stamp_;
  Eigen::Vector3d position_;
  std::atomic<int> accepted_{0}, pictures_{0}, boards_{0};
  tf2_ros::TransformBroadcaster broadcaster_;  // of the camera's mount
};

TEST_F(NodeletsStorm, WorkGoesOnAndIsRightAfterwards) {
  load();
  ASSERT_TRUE(awaitPoses(1));
  rage();
  sleep(8000);
  EXPECT_TRUE(await([this] { return sawEnough(); }))
      << accepted_ << " changes, " << pictures_ << " pictures, " << boards_ << " boards";
  calm();
  info_pub_.publish(info());
  map_pub_.publish(map(map_));
  reconfigureLocator(0);
  EXPECT_TRUE(awaitPoses(20));
  const std::lock_guard<std::mutex> lock(mutex_);
  EXPECT_LT((position_ - T_map_camera_.translation()).norm(), 0.03);
}

TEST_F(NodeletsStorm, NodeletsAreUnloadedWhileTheyWork) {
  rage();
  for (int i = 0; i < 3; ++i) {
    load();
    ASSERT_TRUE(awaitPoses(3));
    for (const char* name : {"/detector", "/driver", "/locator"}) EXPECT_TRUE(loader_.unload(name));
  }
}

TEST_F(NodeletsStorm, ALocatorHasNoThreadOfItsOwn) {
  const auto task = std::filesystem::path("/proc/self/task");
  std::vector<long> threads;
  for (const std::string name : {"first", "second"}) {
    ros::param::set("/" + name + "/cameras", std::vector<std::string>{name});
    const ros::Publisher markers_pub = node_.advertise<MarkerArray>(name, 1);
    ASSERT_TRUE(loader_.load("/" + name, "sextant/MarkerLocator", {}, {}));
    ASSERT_TRUE(await([&] { return markers_pub.getNumSubscribers() > 0; }));
    threads.push_back(std::distance(std::filesystem::directory_iterator(task), {}));
  }
  EXPECT_EQ(threads[1], threads[0]);
}

TEST_F(NodeletsStorm, AStartThatTheQueueDiscardsIsRepeated) {
  ros::CallbackQueue queue(false);  // as nodelet 1.10.0 leaves it during onInit
  ros::NodeHandle node;
  node.setCallbackQueue(&queue);
  int started = 0;
  const StartInQueue start(node, [&started] { ++started; });
  sleep(100);
  queue.callAvailable();
  EXPECT_EQ(started, 0);
  queue.enable();
  EXPECT_TRUE(await([&] { return queue.callAvailable(), started > 0; }));
  sleep(100);
  queue.callAvailable();
  EXPECT_EQ(started, 1);
}

TEST_F(NodeletsStorm, AStartDoesNotOutliveItsNodelet) {
  ros::CallbackQueue queue;
  ros::NodeHandle node;
  node.setCallbackQueue(&queue);
  int started = 0;
  {
    const StartInQueue start(node, [&started] { ++started; });
    EXPECT_TRUE(await([&] { return !queue.isEmpty(); }));
  }
  queue.callAvailable();
  EXPECT_EQ(started, 0);
}

// A fifth of the subscriptions is lost without the lock.
TEST_F(NodeletsStorm, ASubscriptionIsNotLostToTheEndOfAnother) {
  const ros::Publisher words_pub = node_.advertise<std_msgs::String>("words", 1);
  const auto subscribe = [this](const std::string& topic) {
    return node_.subscribe(
        topic, 1, +[](const std_msgs::StringConstPtr&) {});
  };
  const auto begin = [&] {
    const SubscriptionLock lock;
    return subscribe("words");
  };
  const auto end = [](ros::Subscriber& subscriber) {
    const SubscriptionLock lock;
    subscriber.shutdown();
  };
  for (const std::string other : {"other", "another"}) repeat([=](int) { subscribe(other); });
  for (int i = 0; i < 100; ++i) {
    ros::Subscriber before = begin();
    std::thread ending([&] { end(before); });
    ros::Subscriber after = begin();
    ending.join();
    EXPECT_EQ(words_pub.getNumSubscribers(), 1u) << i;
    end(after);
  }
}

TEST_F(NodeletsStorm, RefusedNodeletsLeaveTheOthersAlone) {
  load();
  ros::param::set("/refused/nonsense", 1);
  for (const char* type :
       {"sextant/CameraDriver", "sextant/MarkerDetector", "sextant/MarkerLocator", "sextant/LandmarkSlam"})
    EXPECT_FALSE(loader_.load("/refused", type, {}, {})) << type;
  EXPECT_TRUE(awaitPoses(3));
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) { return sextant::runStorms(argc, argv, "nodelets_storm"); }
