// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sextant/ros/base/param_reader.hpp"
#include "sextant/ros/images/image_player.hpp"
#include "sextant/ros/images/image_source.hpp"

namespace sextant {

/// Parameters of the nodelet sextant/CameraDriver.
struct CameraDriverParams {
  ImageSourceParams source;
  ImagePlayerParams player;
  std::string camera_name = "camera";  ///< as in the calibration file; letters, digits and _
  /// Calibration, a path or a URL (file://, package://); empty: ~/.ros/camera_info/<camera_name>.yaml, where
  /// the calibration tool saves it
  std::string camera_info_url;
  std::string frame_id = "camera_optical_frame";  ///< of the images

  /// @throws std::invalid_argument that names the first field out of range
  void validate() const;
  /// Reads all from a node's private namespace, refuses unknown names and validates.
  static CameraDriverParams fromRos(const ros::NodeHandle& private_node);
};

}  // namespace sextant
