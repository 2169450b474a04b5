// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/localization/marker_locator_params.hpp"

#include <set>
#include <stdexcept>

#include "sextant/base/range.hpp"

namespace sextant {
namespace {

// YAML has no tables with numbers as names, so the ids of "sizes" come as texts.
std::map<int, double> byId(const std::map<std::string, double>& sizes) {
  std::map<int, double> result;
  for (const auto& [name, size] : sizes) {
    if (name.empty() || name.size() > 9 || name.find_first_not_of("0123456789") != std::string::npos)
      throw std::invalid_argument("sizes: '" + name + "' is no marker id");
    result[std::stoi(name)] = size;
  }
  return result;
}

void readLocalization(ParamReader& reader, MarkerLocatorParams& params) {
  reader.read("mode", params.localization.locator.mode);
  reader.read("corner_sigma", params.localization.locator.corner_sigma);
  reader.read("max_reprojection_error", params.localization.locator.max_reprojection_error);
  reader.read("robust_width", params.localization.locator.robust_width);
  reader.read("gate", params.localization.locator.gate);
  reader.read("floor_height_sigma", params.localization.locator.floor_height_sigma);
  reader.read("floor_tilt_sigma", params.localization.locator.floor_tilt_sigma);
  reader.read("decided", params.localization.locator.decided);
  reader.read("ambiguous", params.localization.locator.ambiguous);
  reader.read("constant_covariance", params.localization.locator.constant_covariance);
  reader.read("estimate_noise", params.localization.estimate_noise);
  reader.read("leave_out_moved", params.localization.leave_out_moved);
  reader.read("odometry_position_drift", params.localization.odometry.position_drift);
  reader.read("odometry_heading_drift", params.localization.odometry.heading_drift);
  reader.read("odometry_turn_drift", params.localization.odometry.turn_drift);
  reader.read("odometry_gate", params.localization.odometry.gate);
  reader.read("odometry_recovery", params.localization.odometry.recovery);
}

}  // namespace

void MarkerLocatorParams::validate() const {
  static const std::set<std::string> outputs = {"none", "map_to_odom", "map_to_base"};
  localization.validate();
  text.validate();
  if (outputs.count(tf_output) == 0)
    throw std::invalid_argument("tf_output is '" + tf_output +
                                "', allowed are none, map_to_odom and map_to_base");
  if (tf_output != "none" && base_frame.empty())
    throw std::invalid_argument("tf_output " + tf_output + " needs a base_frame");
  if (needsOdometry() && (base_frame.empty() || odom_frame.empty() || odom_frame == base_frame))
    throw std::invalid_argument(
        "tf_output map_to_odom and use_odometry need a base_frame and an odom_frame that is not the same");
  Range::closed(0, 1000).require("tf_rate", tf_rate, "Hz");
  Range::closed(0, 1).require("camera_window", camera_window, "s");
  Range::closed(0, 1).require("camera_patience", camera_patience, "s");
  Range::closed(0, 10).require("transform_timeout", transform_timeout, "s");
  if (cameras.empty()) throw std::invalid_argument("cameras is empty, name at least one topic of markers");
  requireTopics("cameras", cameras);
}

std::string MarkerLocatorParams::childFrame() const {
  if (tf_output == "none") return "";
  return tf_output == "map_to_odom" ? odom_frame : base_frame;
}

MarkerLocatorParams MarkerLocatorParams::fromRos(const ros::NodeHandle& private_node) {
  MarkerLocatorParams params;
  ParamReader reader(private_node);
  std::map<std::string, double> sizes;
  readLocalization(reader, params);
  reader.read("use_odometry", params.use_odometry);
  reader.read("cameras", params.cameras);
  reader.read("camera_window", params.camera_window);
  reader.read("camera_patience", params.camera_patience);
  reader.read("map_file", params.map_file);
  reader.read("frame", params.text.frame);
  reader.read("family", params.text.family);
  reader.read("size", params.text.size);
  reader.read("sizes", sizes);
  reader.read("parents", params.text.parents);
  reader.read("base_frame", params.base_frame);
  reader.read("odom_frame", params.odom_frame);
  reader.read("tf_output", params.tf_output);
  reader.read("tf_rate", params.tf_rate);
  reader.read("transform_timeout", params.transform_timeout);
  reader.rejectUnknown();
  params.text.sizes = byId(sizes);
  reader.validate(params);
  return params;
}

}  // namespace sextant
