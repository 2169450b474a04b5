// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/detection/marker_detector_params.hpp"

#include <stdexcept>

#include "sextant/base/range.hpp"

namespace sextant {

void MarkerDetectorParams::validate() const {
  detector.validate();
  sizes.validate();
  Range::openLow(0, 10).require("corner_sigma", corner_sigma, "px");
  Range::closed(0, 1000).require("rate", rate, "Hz");
  Range::closed(0, 10000).require("debug_width", debug_width, "px");
  Range::closed(0, 1000).require("debug_rate", debug_rate, "Hz");
  Range::closed(1, 100).require("debug_quality", debug_quality);
  if (publish_tf && tf_prefix.empty())
    throw std::invalid_argument("tf_prefix is empty: the frames could be those of the marker map");
}

MarkerDetectorParams MarkerDetectorParams::fromRos(const ros::NodeHandle& private_node) {
  MarkerDetectorParams params;
  ParamReader reader(private_node);
  reader.read("families", params.detector.families);
  reader.read("search", params.search);
  reader.read("threads", params.detector.threads);
  reader.read("decimate", params.detector.decimate);
  reader.read("max_hamming", params.detector.max_hamming);
  reader.read("min_decision_margin", params.detector.min_decision_margin);
  reader.read("error_correction", params.detector.error_correction);
  reader.read("min_perimeter", params.detector.min_perimeter);
  reader.read("refine_corners", params.detector.refine_corners);
  reader.read("marker_size", params.sizes.size);
  reader.read("marker_sizes", params.sizes.sizes);
  reader.read("corner_sigma", params.corner_sigma);
  reader.read("rate", params.rate);
  reader.read("enabled", params.enabled);
  reader.read("rectified", params.rectified);
  reader.read("compressed", params.compressed);
  reader.read("publish_tf", params.publish_tf);
  reader.read("tf_prefix", params.tf_prefix);
  reader.read("debug_width", params.debug_width);
  reader.read("debug_rate", params.debug_rate);
  reader.read("debug_quality", params.debug_quality);
  params.detector.search = params.search;
  reader.rejectUnknown();
  reader.validate(params);
  return params;
}

}  // namespace sextant
