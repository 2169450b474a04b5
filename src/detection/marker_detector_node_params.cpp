// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/detection/marker_detector_node_params.hpp"

#include <stdexcept>

namespace sextant {

ParamList MarkerDetectorNodeParams::fields() {
  const auto require_prefix = [this](const Param&) {
    if (publish_tf && tf_prefix.empty())
      throw std::invalid_argument("tf_prefix is empty: the frames could have the names of the map's markers");
  };
  const ParamList own = {
      {"corner_sigma", &corner_sigma, Range::openLow(0, 10), "px",
       "standard deviation of corner coordinates, for the covariance of the poses"},
      {"rate", &rate, Range::closed(0, 1000), "Hz",
       "maximum rate of images that are processed; others are dropped; 0: no limit"},
      {"enabled", &enabled, Allowed(), "", "detect from the start; the service `~enable` switches detection"},
      {"rectified", &rectified, Allowed(), "",
       "the image is rectified (without lens distortion): use P and R of the calibration instead of K and D"},
      {"compressed", &compressed, Allowed(), "", "subscribe to `image/compressed` instead of `image`"},
      {"publish_tf", &publish_tf, Allowed(), "",
       "broadcast the pose of every marker in the camera frame, as the tf frame `seen/FAMILY/ID`"},
      {"tf_prefix", &tf_prefix, Allowed("not empty with `publish_tf`", require_prefix), "",
       "prefix of the marker frames, before `FAMILY/ID`"},
      {"debug_width", &debug_width, Range::closed(0, 10000), "px",
       "width of `markers/image`; 0: width of the input"},
      {"debug_rate", &debug_rate, Range::closed(0, 1000), "Hz",
       "maximum rate of `markers/image`; 0: no limit"},
      {"debug_quality", &debug_quality, Range::closed(1, 100), "",
       "JPEG quality of `markers/image/compressed`"},
  };
  return joined({detector.fields(), prefixed("marker_", sizes.fields()), own});
}

}  // namespace sextant
