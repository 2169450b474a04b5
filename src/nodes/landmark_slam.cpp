// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "landmark_slam");
  nodelet::Loader loader(false);
  if (!loader.load(ros::this_node::getName(), "sextant/LandmarkSlam", ros::names::getRemappings(), {}))
    return 1;
  ros::spin();
}
