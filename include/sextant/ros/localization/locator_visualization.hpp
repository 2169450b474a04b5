// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include <deque>

#include "sextant/localization/marker_locator.hpp"

namespace sextant {

/// What rviz shows of a located pose: the lines of sight to the markers used, and the trail of positions.
class LocatorVisualization {
 public:
  void clear() { trail_.clear(); }
  /// @param T_map_camera where the lines of sight begin
  visualization_msgs::MarkerArray update(const LocatedPose& pose, const Pose& T_map_camera,
                                         const MarkerMap& map, const ros::Time& stamp);

 private:
  std::deque<geometry_msgs::Point> trail_;
};

}  // namespace sextant
