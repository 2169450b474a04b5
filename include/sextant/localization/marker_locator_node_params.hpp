// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "sextant/localization/marker_localization.hpp"
#include "sextant/markers/marker_map_file.hpp"

namespace sextant {

/// Parameters of the nodelet sextant/MarkerLocator.
struct MarkerLocatorNodeParams {
  LocalizationParams localization;  ///< parameters of locator and odometry
  std::vector<std::string> cameras = {"markers"};
  std::string map_file;
  TextMapParams text;  ///< for map files in the plain text format
  std::string base_frame = "base_link";
  std::string odom_frame = "odom";
  std::string tf_output = "none";
  std::string initialpose = "never";
  bool use_odometry = false;
  double tf_rate = 20.0;
  double camera_window = 0.01;
  double camera_timeout = 0.05;
  double transform_timeout = 0.1;

  ParamList fields();
  /// Whether the node looks up odometry in tf.
  bool needsOdometry() const { return use_odometry || tf_output == "map_to_odom"; }
  /// Child frame of the published transform; empty: none.
  std::string childFrame() const;
};

}  // namespace sextant
