// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
// All nodelets in this process, in a manager with several threads, while everything changes at once. Worth
// most under a sanitizer: scripts/sanitize.sh.
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <std_srvs/SetBool.h>
#include <stdlib.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "sextant/core/marker_map_file.hpp"
#include "sextant/core/room_renderer.hpp"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kStorm = std::chrono::seconds(8);
constexpr auto kPatience = std::chrono::seconds(60);  // a sanitizer makes everything ten times as slow

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

class NodeletsStorm : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string room = ros::package::getPath("sextant") + "/config/room.txt";
    auto scene = std::make_shared<RoomScene>(RoomSceneParams(), readMarkerMap(room, TextMapParams()));
    picture_ = RoomRenderer(RoomRendererParams(), scene, camera()).render({T_map_camera_}, 0);
    char name[] = "/tmp/sextant_storm_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    ASSERT_TRUE(cv::imwrite(folder_ / "0.png", picture_));
    ros::param::set("/driver/source", folder_.string());
    ros::param::set("/driver/encoding", "mono8");
    ros::param::set("/driver/rate", 50);
    ros::param::set("/driver/loop", true);
    ros::param::set("/locator/map_file", room);
    ros::param::set("/locator/base_frame", "");
    poses_sub_ = node_.subscribe("pose", 100, &NodeletsStorm::onPose, this);
    info_pub_ = node_.advertise<sensor_msgs::CameraInfo>("/image/camera_info", 1, true);
    info_pub_.publish(info());
    spinner_.start();
  }
  void TearDown() override {
    loader_.clear();
    spinner_.stop();
    std::filesystem::remove_all(folder_);
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
    const auto& p = msg->pose.pose.position;
    position_ = {p.x, p.y, p.z};
  }
  int poses() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return poses_;
  }
  bool reach(int poses_wanted) {
    const auto end = Clock::now() + kPatience;
    while (poses() < poses_wanted && Clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return poses() >= poses_wanted;
  }

  // As fast as it can, until the storm is over.
  template <typename Do>
  std::thread repeat(Do what) {
    return std::thread([this, what] {
      for (int i = 0; !over_; ++i) what(i);
    });
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
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  void switchOffAndOn(int) {
    std_srvs::SetBool call;
    for (const bool on : {false, true}) {
      call.request.data = on;
      ros::service::call("/detector/enable", call);
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
  }
  void recalibrate(int i) {
    sensor_msgs::CameraInfo changed = info();
    changed.K[0] = i % 2 ? 500.0 : 0.0;  // without a focal length: no calibration
    info_pub_.publish(changed);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }

  const Pose T_map_camera_ = poseFromXyzRpy({0, 0, 1}, {-M_PI / 2, 0, 0});  // looks along y
  cv::Mat picture_;
  std::filesystem::path folder_;
  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_{2};
  ros::Subscriber poses_sub_;
  ros::Publisher info_pub_;
  std::mutex mutex_;
  int poses_ = 0;             // with the mutex
  Eigen::Vector3d position_;  // with the mutex
  std::atomic<bool> over_{false};
  std::atomic<int> accepted_{0}, pictures_{0};
  nodelet::Loader loader_{ros::NodeHandle("~")};
};

TEST_F(NodeletsStorm, WorkGoesOnAndIsRightAfterwards) {
  load();
  ASSERT_TRUE(reach(1));
  std::vector<std::thread> storm;
  storm.push_back(repeat([this](int i) { reconfigureDetector(i); }));
  storm.push_back(repeat([this](int i) { reconfigureLocator(i); }));
  storm.push_back(repeat([this](int i) { lookAtPictures(i); }));
  storm.push_back(repeat([this](int i) { switchOffAndOn(i); }));
  storm.push_back(repeat([this](int i) { recalibrate(i); }));
  std::this_thread::sleep_for(kStorm);
  over_ = true;
  for (std::thread& each : storm) each.join();
  info_pub_.publish(info());
  reconfigureLocator(0);
  EXPECT_GT(accepted_, 10);
  EXPECT_GT(pictures_, 2);
  EXPECT_TRUE(reach(poses() + 20));
  const std::lock_guard<std::mutex> lock(mutex_);
  EXPECT_LT((position_ - T_map_camera_.translation()).norm(), 0.03);
}

TEST_F(NodeletsStorm, NodeletsAreUnloadedWhileTheyWork) {
  for (int i = 0; i < 3; ++i) {
    load();
    ASSERT_TRUE(reach(poses() + 3));
    for (const char* name : {"/detector", "/driver", "/locator"}) EXPECT_TRUE(loader_.unload(name));
  }
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "nodelets_storm");
  return RUN_ALL_TESTS();
}
