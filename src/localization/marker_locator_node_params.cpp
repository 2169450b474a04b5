// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_locator_node_params.hpp"

#include <stdexcept>

namespace sextant {
namespace {

ParamList cameraFields(MarkerLocatorNodeParams& params) {
  const auto require_cameras = [](const Param& param) {
    if (std::get<std::vector<std::string>*>(param.value)->empty())
      throw std::invalid_argument("cameras is empty: set at least one topic of markers");
    topics().check(param);
  };
  return {
      {"cameras", &params.cameras, Allowed("not empty", require_cameras), "",
       "topics of sextant/MarkerArray, one per camera; images of one instant give one pose"},
      {"camera_window", &params.camera_window, Range::closed(0, 1), "s",
       "maximum difference between the stamps of images of one instant"},
      {"camera_timeout", &params.camera_timeout, Range::closed(0, 1), "s",
       "maximum time to wait for the images of the other cameras; cameras that were silent for 1 s are not "
       "waited for"},
  };
}

}  // namespace

ParamList MarkerLocatorNodeParams::fields() {
  const auto require_base = [this](const Param&) {
    if (tf_output != "none" && base_frame.empty())
      throw std::invalid_argument("tf_output " + tf_output + " needs a base_frame");
  };
  const auto require_odometry = [this](const Param&) {
    if (needsOdometry() && (base_frame.empty() || odom_frame.empty() || odom_frame == base_frame))
      throw std::invalid_argument(
          "tf_output map_to_odom and use_odometry need a base_frame and a different odom_frame");
  };
  const auto require_use_of_odometry = [this](const Param& param) {
    oneOf({"never", "relocalized"}).check(param);
    if (initialpose != "never" && !needsOdometry())
      throw std::invalid_argument("initialpose " + initialpose + " needs use_odometry: true");
  };
  const ParamList own = {
      {"use_odometry", &use_odometry, Allowed(), "",
       "use odometry to resolve ambiguous poses and reject outliers; always on with `map_to_odom`"},
      {"map_file", &map_file, Allowed(), "",
       "[marker map](marker_map.md) file; empty: wait for `marker_map/entries`"},
      {"tf_output", &tf_output, oneOf({"none", "map_to_odom", "map_to_base"}), "",
       "[transform to publish](frames.md#tf_output)"},
      {"initialpose", &initialpose, Allowed("never, relocalized", require_use_of_odometry), "",
       "publish `initialpose` when localization starts, and when the markers show that odometry was wrong or "
       "the robot was carried; needs `use_odometry`"},
      {"base_frame", &base_frame, Allowed("not empty with a `tf_output`", require_base), "",
       "frame whose pose is published; empty: the camera's optical frame"},
      {"odom_frame", &odom_frame, Allowed("not `base_frame`", require_odometry), "",
       "odometry frame, for `use_odometry` and `tf_output: map_to_odom`"},
      {"tf_rate", &tf_rate, Range::closed(0, 1000), "Hz",
       "rate at which `map_to_odom` is repeated between images while odometry is received; 0: not repeated"},
      {"transform_timeout", &transform_timeout, Range::closed(0, 10), "s",
       "maximum time to wait for a transform"},
  };
  return joined({localization.fields(), cameraFields(*this), own, text.fields()});
}

std::string MarkerLocatorNodeParams::childFrame() const {
  if (tf_output == "none") return "";
  return tf_output == "map_to_odom" ? odom_frame : base_frame;
}

}  // namespace sextant
