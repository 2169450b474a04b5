// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sextant/detection/marker_detector.hpp"
#include "sextant/markers/observed_marker.hpp"
#include "sextant/ros/base/param_reader.hpp"

namespace sextant {

/// Parameters of the nodelet sextant/MarkerDetector.
struct MarkerDetectorParams {
  DetectorParams detector;
  std::string search = "tracking";  ///< detector.search of a node, whose images are one camera's, in order
  MarkerSizes sizes;                ///< marker_size, marker_sizes
  double corner_sigma = 0.3;  ///< noise of a corner coordinate for the poses' covariance, pixels, (0, 10]
  double rate = 0.0;          ///< images a second that are searched at most, Hz, [0, 1000]; 0: every image
  bool enabled = true;        ///< search from the start; the service ~enable switches it
  bool rectified = false;     ///< the image is rectified: P and R count instead of K and D
  bool compressed = false;    ///< hear image/compressed instead of image
  bool publish_tf = false;    ///< broadcast every marker's pose in the camera frame
  std::string tf_prefix = "seen/";  ///< its frame is <prefix><family>/<id>
  int debug_width = 0;              ///< of markers/image, pixels, [0, 10000]; 0: as the image
  double debug_rate = 0.0;          ///< of markers/image at most, Hz, [0, 1000]; 0: every image
  int debug_quality = 80;           ///< JPEG quality of markers/image/compressed, [1, 100]

  /// @throws std::invalid_argument that names the first field out of range
  void validate() const;
  /// Reads all from a node's private namespace, refuses unknown names and validates.
  static MarkerDetectorParams fromRos(const ros::NodeHandle& private_node);
};

}  // namespace sextant
