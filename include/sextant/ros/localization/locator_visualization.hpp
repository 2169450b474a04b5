// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include <deque>

#include "sextant/localization/marker_locator.hpp"

namespace sextant {

/// Visualization of a located pose for rviz: the lines of sight to the markers used, and the trail of
/// positions.
class LocatorVisualization {
 public:
  void clear() { trail_.clear(); }  ///< restarts the trail
  /// Adds a pose. @param T_map_camera origin of the lines of sight
  visualization_msgs::MarkerArray update(const LocatedPose& pose, const Pose& T_map_camera,
                                         const MarkerMap& map, const ros::Time& stamp);

 private:
  std::deque<geometry_msgs::Point> trail_;
};

}  // namespace sextant
