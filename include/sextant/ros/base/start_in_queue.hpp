// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <functional>
#include <mutex>
#include <utility>

namespace sextant {

/// Runs the rest of a nodelet's initialization in its callback queue. Callbacks run in another thread and do
/// not wait for the end of onInit, so they could otherwise see a half-initialized nodelet. Code that throws
/// belongs in onInit itself. The process must spin the global callback queue, as nodelet managers do.
class StartInQueue {
 public:
  /// @param start called once
  StartInQueue(const ros::NodeHandle& node, std::function<void()> start)
      : call_(boost::make_shared<Call>(std::move(start))), queue_(node.getCallbackQueue()) {
    ros::WallTimerOptions repeated(
        ros::WallDuration(0.01), [this](const ros::WallTimerEvent&) { add(); },
        ros::getGlobalCallbackQueue());
    const std::lock_guard<std::mutex> lock(mutex_);
    timer_ = node.createWallTimer(repeated);
  }
  StartInQueue(const StartInQueue&) = delete;
  StartInQueue& operator=(const StartInQueue&) = delete;

 private:
  struct Call : ros::CallbackInterface {
    explicit Call(std::function<void()> function) : start(std::move(function)) {}
    CallResult call() override {
      if (!called.exchange(true)) start();
      return Success;
    }
    const std::function<void()> start;
    std::atomic<bool> called{false};
  };

  // nodelet 1.10.0 discards what is added to the queue before onInit has returned, so this is repeated.
  void add() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (call_->called)
      timer_.stop();
    else
      queue_->addCallback(call_);
  }

  const boost::shared_ptr<Call> call_;
  ros::CallbackQueueInterface* const queue_;
  std::mutex mutex_;  // of the timer, which can expire before it is assigned
  ros::WallTimer timer_;
};

}  // namespace sextant
