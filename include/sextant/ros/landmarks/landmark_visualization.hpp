// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/MarkerArray.h>

#include <set>
#include <string>

#include "sextant/landmarks/landmark_slam.hpp"

namespace sextant {

/// Of the colour that is in its name, or else always the same one.
std_msgs::ColorRGBA colourOfClass(const std::string& class_name);

/// What rviz shows of landmarks: pillars of the class's colour with their names, 2 sigma on the floor around
/// them, and arrows where they have headings.
class LandmarkVisualization {
 public:
  /// Also deletes what was shown before and is gone.
  visualization_msgs::MarkerArray update(const LandmarkSlam& slam, const std::string& frame,
                                         const ros::Time& stamp);

 private:
  std::set<int> shown_;  // keys
};

}  // namespace sextant
