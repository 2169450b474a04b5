// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_locator_node_params.hpp"

#include <stdexcept>

namespace sextant {

ParamList MarkerLocatorNodeParams::fields() {
  const auto require_cameras = [](const Param& param) {
    if (std::get<std::vector<std::string>*>(param.value)->empty())
      throw std::invalid_argument("cameras is empty, name at least one topic of markers");
    topics().check(param);
  };
  const auto require_base = [this](const Param&) {
    if (tf_output != "none" && base_frame.empty())
      throw std::invalid_argument("tf_output " + tf_output + " needs a base_frame");
  };
  const auto require_odometry = [this](const Param&) {
    if (needsOdometry() && (base_frame.empty() || odom_frame.empty() || odom_frame == base_frame))
      throw std::invalid_argument(
          "tf_output map_to_odom and use_odometry need a base_frame and an odom_frame that is not the same");
  };
  const ParamList own = {
      {"use_odometry", &use_odometry, Allowed(), "",
       "odometry decides between the poses that a marker leaves, and refuses false ones; always so with "
       "`map_to_odom`"},
      {"cameras", &cameras, Allowed("not empty", require_cameras), "",
       "topics of sextant/MarkerArray, one a camera: what they see at one instant is solved together"},
      {"camera_window", &camera_window, Range::closed(0, 1), "s",
       "one instant: the stamps are no farther apart"},
      {"camera_patience", &camera_patience, Range::closed(0, 1), "s",
       "how long the images of the other cameras are waited for; one that is silent for 1 s is not"},
      {"map_file", &map_file, Allowed(), "",
       "[marker map](marker_map.md); empty: wait for `marker_map/entries`"},
      {"tf_output", &tf_output, oneOf({"none", "map_to_odom", "map_to_base"}), "",
       "[which transform is published](frames.md#tf_output)"},
      {"base_frame", &base_frame, Allowed("not empty with a `tf_output`", require_base), "",
       "whose pose is published; empty: the camera's own"},
      {"odom_frame", &odom_frame, Allowed("not `base_frame`", require_odometry), "",
       "for `tf_output: map_to_odom`"},
      {"tf_rate", &tf_rate, Range::closed(0, 1000), "Hz",
       "`map_to_odom` is repeated between images as long as odometry comes; 0: it is not"},
      {"transform_timeout", &transform_timeout, Range::closed(0, 10), "s",
       "how long a missing transform is waited for"},
  };
  return joined({localization.fields(), own, text.fields()});
}

std::string MarkerLocatorNodeParams::childFrame() const {
  if (tf_output == "none") return "";
  return tf_output == "map_to_odom" ? odom_frame : base_frame;
}

}  // namespace sextant
