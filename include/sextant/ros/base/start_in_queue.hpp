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
  /// @param start called once, but not after the destruction of this object has begun
  StartInQueue(const ros::NodeHandle& node, std::function<void()> start)
      : repeated_(boost::make_shared<Repeated>()) {
    repeated_->call = boost::make_shared<Call>(std::move(start));
    repeated_->queue = node.getCallbackQueue();
    const auto add = [repeated = repeated_.get()](const ros::WallTimerEvent&) { repeated->add(); };
    ros::WallTimerOptions options(ros::WallDuration(0.01), add, ros::getGlobalCallbackQueue());
    options.tracked_object = repeated_;
    const std::lock_guard<std::mutex> lock(repeated_->mutex);
    repeated_->timer = node.createWallTimer(options);
  }
  ~StartInQueue() { repeated_->call->called = true; }
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

  // Lives until its last callback has ended.
  struct Repeated {
    // nodelet 1.10.0 discards what is added to the queue before onInit has returned, so this is repeated.
    void add() {
      const std::lock_guard<std::mutex> lock(mutex);
      if (call->called)
        timer.stop();
      else
        queue->addCallback(call);
    }

    boost::shared_ptr<Call> call;
    ros::CallbackQueueInterface* queue = nullptr;
    std::mutex mutex;  // of the timer, which can expire before it is assigned
    ros::WallTimer timer;
  };

  const boost::shared_ptr<Repeated> repeated_;
};

}  // namespace sextant
