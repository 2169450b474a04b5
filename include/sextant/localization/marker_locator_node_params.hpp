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
  LocalizationParams localization;
  std::vector<std::string> cameras = {"markers"};
  std::string map_file;
  TextMapParams text;
  std::string base_frame = "base_link";
  std::string odom_frame = "odom";
  std::string tf_output = "none";
  bool use_odometry = false;
  double tf_rate = 20.0;
  double camera_window = 0.01;
  double camera_patience = 0.05;
  double transform_timeout = 0.1;

  ParamList fields();
  /// Whether odometry is looked up in tf.
  bool needsOdometry() const { return use_odometry || tf_output == "map_to_odom"; }
  /// The frame that tf_output places in the map; empty: none
  std::string childFrame() const;
};

}  // namespace sextant
