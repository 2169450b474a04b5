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

/// A queue of messages that wait for the transform of their frame at their stamp.
class TransformQueue {
 public:
  /// Called with the transform.
  using Work = std::function<void(const Pose& T_target_frame)>;
  /// Called when the transform did not arrive in time.
  using OnTimeout = std::function<void(const std::string& reason)>;

  /// @param timeout how long a message waits, seconds
  TransformQueue(const tf2_ros::Buffer& buffer, double timeout) : buffer_(buffer), timeout_(timeout) {}

  /// Queues work until the transform to the header's frame is known.
  void add(const std_msgs::Header& header, Work work) {
    items_.push_back({header, std::move(work), ros::SteadyTime::now() + ros::WallDuration(timeout_)});
  }
  /// Processes the messages whose transform is available, and drops those that waited longer than the
  /// timeout.
  void process(const std::string& target, const OnTimeout& on_timeout);
  /// Whether no work is waiting.
  bool empty() const { return items_.empty(); }
  /// Drops all work.
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
