// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <functional>

namespace sextant {

/// Does what is left of a nodelet's start in the queue of its callbacks: they do not wait for the end of
/// onInit, and would meet what it has half made in another thread. What throws must have been done before.
/// @return to be kept: without it nothing is started
inline ros::WallTimer startInQueue(const ros::NodeHandle& node, const std::function<void()>& start) {
  constexpr bool once = true;
  return node.createWallTimer(
      ros::WallDuration(0.001), [start](const ros::WallTimerEvent&) { start(); }, once);
}

}  // namespace sextant
