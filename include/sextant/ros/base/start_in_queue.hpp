// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <functional>

namespace sextant {

/// Runs the rest of a nodelet's initialization in its callback queue. Callbacks run in another thread and do
/// not wait for the end of onInit, so they could otherwise see a half-initialized nodelet. Code that throws
/// belongs in onInit itself.
/// @return the timer, which the caller must keep until start has run
inline ros::WallTimer startInQueue(const ros::NodeHandle& node, const std::function<void()>& start) {
  constexpr bool once = true;
  return node.createWallTimer(
      ros::WallDuration(0.001), [start](const ros::WallTimerEvent&) { start(); }, once);
}

}  // namespace sextant
