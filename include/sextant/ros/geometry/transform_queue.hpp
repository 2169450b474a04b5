// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <std_msgs/Header.h>
#include <tf2_ros/buffer.h>

#include <functional>
#include <list>
#include <string>

#include "sextant/geometry/pose.hpp"

namespace sextant {

/// Messages that wait until tf knows where their frames are at their stamps.
class TransformQueue {
 public:
  using Work = std::function<void(const Pose& T_target_frame)>;
  using Tell = std::function<void(const std::string& why_not)>;

  TransformQueue(const tf2_ros::Buffer& buffer, double timeout) : buffer_(buffer), timeout_(timeout) {}

  void add(const std_msgs::Header& header, Work work) {
    items_.push_back({header, std::move(work), ros::SteadyTime::now() + ros::WallDuration(timeout_)});
  }
  /// Does the work of those whose transform is there, and drops those that have waited for too long.
  void work(const std::string& target, const Tell& tell);
  bool empty() const { return items_.empty(); }
  void clear() { items_.clear(); }

 private:
  struct Item {
    std_msgs::Header header;
    Work work;
    ros::SteadyTime deadline;
  };
  const tf2_ros::Buffer& buffer_;
  double timeout_;
  std::list<Item> items_;
};

}  // namespace sextant
