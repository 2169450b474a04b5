// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/trouble_log.hpp"

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/console.h>
#include <ros/time.h>

namespace sextant {
namespace {
constexpr double kLogPeriod = 60.0;  // seconds
}

void TroubleLog::report(const std::string& kind, const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Kind& entry = kinds_[kind];
  ++entry.count;
  current_ = text;
  const double now = ros::SteadyTime::now().toSec();
  if (now - entry.last_logged < kLogPeriod) return;
  entry.last_logged = now;
  ROS_WARN_STREAM(name_ << ": " << text);
}

void TroubleLog::refused(const std::string& kind, const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++kinds_[kind].count;
  ROS_ERROR_STREAM(name_ << ": " << text);
}

void TroubleLog::succeeded() {
  const std::lock_guard<std::mutex> lock(mutex_);
  current_.clear();
}

void TroubleLog::fill(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  using diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (current_.empty())
    status.summary(DiagnosticStatus::OK, "working");
  else
    status.summary(DiagnosticStatus::WARN, current_);
  for (const auto& [kind, entry] : kinds_) status.add("not used: " + kind, entry.count);
}

}  // namespace sextant
