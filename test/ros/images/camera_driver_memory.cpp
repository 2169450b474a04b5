// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
// Loads the nodelet into this process, as a manager does, and checks that its images are not copied.
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <stdlib.h>

#include <boost/make_shared.hpp>
#include <chrono>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <set>

namespace {

using Clock = std::chrono::steady_clock;

class CameraDriverInThisProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/sextant_camera_driver_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    for (int i = 0; i < 5; ++i)
      ASSERT_TRUE(
          cv::imwrite(folder_ / (std::to_string(i) + ".png"), cv::Mat(48, 64, CV_8UC1, cv::Scalar(i))));
    ros::param::set("/driver/source", folder_.string());
    ros::param::set("/driver/encoding", "mono8");
    ros::param::set("/driver/rate", 100);
    ros::param::set("/driver/loop", true);
  }
  void TearDown() override {
    std::filesystem::remove_all(folder_);
    ros::param::del("/driver");
  }

  // roscpp creates a message only for deserialization.
  ros::Subscriber subscribe() {
    using Callback = const boost::shared_ptr<const sensor_msgs::Image>&;
    ros::SubscribeOptions options;
    options.initByFullCallbackType<Callback>(
        "image_raw", 100, [this](Callback image) { images_.push_back(image); },
        [this] {
          ++unpacked_;
          return boost::make_shared<sensor_msgs::Image>();
        });
    return node_.subscribe(options);
  }

  void receive(size_t number) {
    for (const auto end = Clock::now() + std::chrono::seconds(20);
         images_.size() < number && Clock::now() < end;)
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
    ASSERT_GE(images_.size(), number);
  }

  std::filesystem::path folder_;
  ros::NodeHandle node_;
  std::vector<sensor_msgs::ImageConstPtr> images_;
  int unpacked_ = 0;
  nodelet::Loader loader_{false};
};

TEST_F(CameraDriverInThisProcess, HandsOverItsOwnMemoryAndNeverWritesIntoItAgain) {
  const auto subscriber = subscribe();
  ASSERT_TRUE(loader_.load("/driver", "sextant/CameraDriver", {}, {}));
  receive(20);
  EXPECT_EQ(unpacked_, 0);
  std::set<const uint8_t*> memory;
  for (size_t i = 0; i < 20; ++i) {
    memory.insert(images_[i]->data.data());
    EXPECT_EQ(images_[i]->data, std::vector<uint8_t>(48 * 64, i % 5)) << i;
  }
  EXPECT_EQ(memory.size(), 20u);
}

TEST_F(CameraDriverInThisProcess, IsUnloadedAtOnceWhileItPlays) {
  const auto subscriber = subscribe();
  ASSERT_TRUE(loader_.load("/driver", "sextant/CameraDriver", {}, {}));
  receive(3);
  const auto begin = Clock::now();
  ASSERT_TRUE(loader_.unload("/driver"));
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(1));
}

TEST_F(CameraDriverInThisProcess, AWrongParameterLeavesTheProcessAlive) {
  ros::param::set("/driver/widht", 640);
  EXPECT_FALSE(loader_.load("/driver", "sextant/CameraDriver", {}, {}));
  ros::param::del("/driver/widht");
  const auto subscriber = subscribe();
  ASSERT_TRUE(loader_.load("/driver", "sextant/CameraDriver", {}, {}));
  receive(1);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "camera_driver_memory");
  return RUN_ALL_TESTS();
}
