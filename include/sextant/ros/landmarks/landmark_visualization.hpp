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

/// Colour named in the class, or else one derived from a hash of the class.
std_msgs::ColorRGBA colourOfClass(const std::string& class_name);

/// Markers for rviz: a pillar in the colour of its class with its name, its 2-sigma ellipse on the floor, and
/// an arrow if it has a heading.
class LandmarkVisualization {
 public:
  /// Markers of all landmarks; removed landmarks are deleted.
  visualization_msgs::MarkerArray update(const LandmarkSlam& slam, const std::string& frame,
                                         const ros::Time& stamp);

 private:
  std::set<int> shown_;  // keys of the landmarks in rviz
};

}  // namespace sextant
