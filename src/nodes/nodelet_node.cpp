// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Runs a nodelet as a node: CMakeLists.txt builds this file once for each nodelet, with its NODE and NODELET.
#include <nodelet/loader.h>
#include <ros/ros.h>

#include "sextant/ros/base/registration_check.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, NODE);
  nodelet::Loader loader(false);
  if (!loader.load(ros::this_node::getName(), NODELET, ros::names::getRemappings(), {})) return 1;
  const sextant::RegistrationCheck check;
  ros::spin();
}
