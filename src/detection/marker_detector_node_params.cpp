// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/detection/marker_detector_node_params.hpp"

#include <stdexcept>

namespace sextant {

ParamList MarkerDetectorNodeParams::fields() {
  const auto require_prefix = [this](const Param&) {
    if (publish_tf && tf_prefix.empty())
      throw std::invalid_argument("tf_prefix is empty: the frames could be those of the marker map");
  };
  const ParamList own = {
      {"corner_sigma", &corner_sigma, Range::openLow(0, 10), "px",
       "noise of a corner coordinate, from which the covariance follows"},
      {"rate", &rate, Range::closed(0, 1000), "Hz",
       "images a second that are searched at most; the others are dropped before any work. 0: every image"},
      {"enabled", &enabled, Allowed(), "", "search from the start; the service `~enable` switches it"},
      {"rectified", &rectified, Allowed(), "",
       "the image is rectified: P and R of the calibration count instead of K and D"},
      {"compressed", &compressed, Allowed(), "", "subscribe to `image/compressed`"},
      {"publish_tf", &publish_tf, Allowed(), "", "broadcast every marker's pose in the camera frame"},
      {"tf_prefix", &tf_prefix, Allowed("not empty with `publish_tf`", require_prefix), "",
       "the frames are `PREFIX FAMILY/ID` without the blank"},
      {"debug_width", &debug_width, Range::closed(0, 10000), "px", "of `markers/image`; 0: as the image"},
      {"debug_rate", &debug_rate, Range::closed(0, 1000), "Hz", "of `markers/image` at most; 0: every image"},
      {"debug_quality", &debug_quality, Range::closed(1, 100), "",
       "JPEG quality of `markers/image/compressed`"},
  };
  return joined({detector.fields(), prefixed("marker_", sizes.fields()), own});
}

}  // namespace sextant
