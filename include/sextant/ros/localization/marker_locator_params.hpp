// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "sextant/localization/marker_localization.hpp"
#include "sextant/markers/marker_map_file.hpp"
#include "sextant/ros/base/param_reader.hpp"

namespace sextant {

/// Parameters of the nodelet sextant/MarkerLocator.
struct MarkerLocatorParams {
  LocalizationParams localization;
  std::vector<std::string> cameras = {"markers"};  ///< topics of sextant/MarkerArray, one a camera
  std::string map_file;                            ///< marker map; empty: wait for marker_map/entries
  TextMapParams text;  ///< frame, family, size, sizes, parents: for a map file in the plain text format
  std::string base_frame = "base_link";  ///< whose pose is told; empty: the camera's own
  std::string odom_frame = "odom";       ///< for tf_output map_to_odom
  std::string tf_output = "none";        ///< none | map_to_odom | map_to_base
  bool use_odometry = false;       ///< decide and refuse by odom_frame -> base_frame; map_to_odom always does
  double tf_rate = 20.0;           ///< map_to_odom is repeated between images, Hz, [0, 1000]; 0: it is not
  double camera_window = 0.01;     ///< stamps of cameras that see one instant are no farther apart, s, [0, 1]
  double camera_patience = 0.05;   ///< how long the images of the other cameras are waited for, s, [0, 1]
  double transform_timeout = 0.1;  ///< how long a missing transform is waited for, seconds, [0, 10]

  /// @throws std::invalid_argument that names the first field out of range
  void validate() const;
  /// Whether odometry is asked of tf.
  bool needsOdometry() const { return use_odometry || tf_output == "map_to_odom"; }
  /// The frame that tf_output places in the map; empty: none
  std::string childFrame() const;
  /// Reads all from a node's private namespace, refuses unknown names and validates.
  static MarkerLocatorParams fromRos(const ros::NodeHandle& private_node);
};

}  // namespace sextant
