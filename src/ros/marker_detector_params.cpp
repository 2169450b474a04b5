// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/marker_detector_params.hpp"

#include <stdexcept>

namespace sextant {

void MarkerDetectorParams::validate() const {
  detector.validate();
  sizes.validate();
  if (!(corner_sigma > 0 && corner_sigma <= 10))
    throw std::invalid_argument("corner_sigma must be in (0, 10] px");
  if (debug_width < 0 || debug_width > 10000)
    throw std::invalid_argument("debug_width must be in [0, 10000] px");
  if (!(debug_rate >= 0 && debug_rate <= 1000))
    throw std::invalid_argument("debug_rate must be in [0, 1000] Hz");
  if (debug_quality < 1 || debug_quality > 100)
    throw std::invalid_argument("debug_quality must be in [1, 100]");
  if (publish_tf && tf_prefix.empty())
    throw std::invalid_argument("tf_prefix is empty: the frames could be those of the marker map");
}

MarkerDetectorParams MarkerDetectorParams::fromRos(const ros::NodeHandle& private_node) {
  MarkerDetectorParams params;
  ParamReader reader(private_node);
  reader.read("families", params.detector.families);
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
  reader.read("enabled", params.enabled);
  reader.read("rectified", params.rectified);
  reader.read("compressed", params.compressed);
  reader.read("publish_tf", params.publish_tf);
  reader.read("tf_prefix", params.tf_prefix);
  reader.read("debug_width", params.debug_width);
  reader.read("debug_rate", params.debug_rate);
  reader.read("debug_quality", params.debug_quality);
  reader.rejectUnknown();
  reader.validate(params);
  return params;
}

}  // namespace sextant
