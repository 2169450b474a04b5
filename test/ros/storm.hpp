// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <stdlib.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace sextant {

/// Stress test: nodelets in this process, in a manager with several threads, while everything changes at
/// once. Most useful under a sanitizer: tools/sanitize.sh.
class Storm : public ::testing::Test {
 protected:
  using Clock = std::chrono::steady_clock;

  /// @param tick period of /clock; it jumps back after a number of ticks, like a restarted bag
  Storm(std::chrono::milliseconds tick, int ticks_to_jump) : tick_(tick), ticks_to_jump_(ticks_to_jump) {}

  void SetUp() override {
    char name[] = "/tmp/sextant_storm_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    calm();
    loader_.clear();
    finished_ = true;
    if (world_.joinable()) world_.join();
    spinner_.stop();
    std::filesystem::remove_all(folder_);
  }

  /// @param onTick called before every tick of /clock is published @param number of the tick, from 1
  void begin(std::function<void(const ros::Time& now, int number)> onTick) {
    spinner_.start();
    world_ = std::thread([this, onTick = std::move(onTick)] { run(onTick); });
  }

  /// Calls a function as fast as possible, until calm(). @param what receives the number of previous calls
  void repeat(std::function<void(int)> what) {
    raging_ = true;
    storm_.emplace_back([this, what = std::move(what)] {
      for (int i = 0; raging_; ++i) what(i);
    });
  }
  void calm() {
    raging_ = false;
    for (std::thread& each : storm_) each.join();
    storm_.clear();
  }

  static bool await(const std::function<bool()>& what) {
    const auto patience = std::chrono::seconds(60);  // a sanitizer makes everything ten times as slow
    const auto end = Clock::now() + patience;
    while (!what() && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return what();
  }
  static void sleep(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  }

  static constexpr double kJump = 5.0;  // seconds, back

  std::filesystem::path folder_;  // of this test's own
  ros::NodeHandle node_;
  nodelet::Loader loader_{ros::NodeHandle("~")};

 private:
  void run(const std::function<void(const ros::Time&, int)>& onTick) {
    const auto clock_pub = node_.advertise<rosgraph_msgs::Clock>("/clock", 10);
    rosgraph_msgs::Clock now;
    now.clock = ros::Time(1000.0);
    for (int number = 1; !finished_; ++number) {
      now.clock += ros::Duration(std::chrono::duration<double>(tick_).count());
      if (raging_ && number % ticks_to_jump_ == 0) now.clock -= ros::Duration(kJump);
      onTick(now.clock, number);
      clock_pub.publish(now);
      std::this_thread::sleep_for(tick_);
    }
  }

  std::chrono::milliseconds tick_;
  int ticks_to_jump_;
  ros::AsyncSpinner spinner_{2};
  std::atomic<bool> raging_{false}, finished_{false};
  std::thread world_;
  std::vector<std::thread> storm_;
};

inline int runStorms(int argc, char** argv, const std::string& node) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, node);
  ros::param::set("/use_sim_time", true);
  return RUN_ALL_TESTS();
}

}  // namespace sextant
