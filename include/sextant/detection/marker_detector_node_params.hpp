// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sextant/detection/marker_detector.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

/// Parameters of the nodelet sextant/MarkerDetector.
struct MarkerDetectorNodeParams {
  MarkerDetectorNodeParams() { detector.search = "tracking"; }  // the node receives the images of one camera

  DetectorParams detector;  ///< families, search and refinement
  MarkerSizes sizes;        ///< edge lengths of the markers, for their poses
  double corner_sigma = 0.3;
  double rate = 0.0;
  bool enabled = true;
  bool rectified = false;
  bool compressed = false;
  bool publish_tf = false;
  std::string tf_prefix = "seen/";
  int debug_width = 0;
  double debug_rate = 0.0;
  int debug_quality = 80;

  ParamList fields();
};

}  // namespace sextant
