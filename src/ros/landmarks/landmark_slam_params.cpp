// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/landmarks/landmark_slam_params.hpp"

#include <cmath>
#include <stdexcept>

#include "sextant/base/range.hpp"

namespace sextant {
namespace {

void readFilter(ParamReader& reader, LandmarkSlamNodeParams& params) {
  reader.read("scale_sigma", params.slam.filter.scale_sigma);
  reader.read("scale_drift", params.slam.filter.scale_drift);
  reader.read("clock_sigma", params.slam.filter.clock_sigma);
  reader.read("turn_by_turn", params.timeline.odometry.turn_by_turn);
  reader.read("turn_by_way", params.timeline.odometry.turn_by_way);
  reader.read("way_by_way", params.timeline.odometry.way_by_way);
  reader.read("way_by_turn", params.timeline.odometry.way_by_turn);
  reader.read("aside_by_way", params.timeline.odometry.aside_by_way);
  reader.read("lag", params.timeline.lag);
  reader.read("clock_offset", params.timeline.clock_offset);
}

void readLandmarks(ParamReader& reader, LandmarkSlamNodeParams& params) {
  reader.read("gate", params.slam.association.gate);
  reader.read("doubt", params.slam.association.doubt);
  reader.read("margin", params.slam.association.margin);
  reader.read("density", params.slam.association.density);
  reader.read("new_margin", params.slam.association.new_margin);
  reader.read("effort", params.slam.association.effort);
  reader.read("candidate_gate", params.slam.candidates.gate);
  reader.read("candidate_sightings", params.slam.candidates.sightings);
  reader.read("candidate_memory", params.slam.candidates.memory);
  reader.read("max_range", params.slam.sensor.max_range);
  reader.read("min_range", params.slam.sensor.min_range);
  reader.read("field_of_view", params.slam.sensor.field_of_view);
  reader.read("detection", params.slam.sensor.detection);
  reader.read("phantom", params.slam.sensor.phantom);
  reader.read("width", params.slam.sensor.width);
  reader.read("separation", params.slam.sensor.separation);
  reader.read("match_gate", params.slam.matching.gate);
  reader.read("match_certainty", params.slam.matching.certainty);
  reader.read("match_present", params.slam.matching.present);
  reader.read("lost_after", params.slam.lost_after);
  reader.read("read_only", params.slam.read_only);
  reader.read("decided", params.markers.decided);
  reader.read("corner_sigma", params.markers.corner_sigma);
  reader.read("tilt_sigma", params.markers.tilt_sigma);
}

void requireThree(const std::string& name, const std::vector<double>& values) {
  if (values.size() != 3)
    throw std::invalid_argument(name + " has " + std::to_string(values.size()) +
                                " numbers, needed are x, y (m) and heading (rad)");
  for (const double value : values) Range::closed(-1e9, 1e9).require(name, value);
}

}  // namespace

void LandmarkSlamNodeParams::validate() const {
  slam.validate();
  timeline.validate();
  markers.validate();
  requireTopics("cameras", cameras);
  requireOneOf("start", start, {"origin", "map", "unknown"});
  if (!start_pose.empty()) requireThree("start_pose", start_pose);
  requireThree("pose_sigma", pose_sigma);
  for (const double sigma : pose_sigma) Range::openLow(0, 1000).require("pose_sigma", sigma);
  if (map_frame.empty()) throw std::invalid_argument("map_frame is empty, name the frame of the map");
  requireOneOf("tf_output", tf_output, {"none", "map_to_odom", "map_to_base"});
  for (const std::string& frame : {odom_frame, base_frame})
    if (frame == map_frame)
      throw std::invalid_argument("map_frame is '" + map_frame + "', and so is another");
  if (!odom_frame.empty() && odom_frame == base_frame)
    throw std::invalid_argument("odom_frame is '" + odom_frame + "', and so is base_frame");
  Range::closed(0, 10).require("transform_timeout", transform_timeout, "s");
}

Pose2 LandmarkSlamNodeParams::startPose() const {
  return start_pose.empty() ? Pose2{} : Pose2{{start_pose[0], start_pose[1]}, wrapped(start_pose[2])};
}

Eigen::Matrix3d LandmarkSlamNodeParams::startCovariance() const {
  return Eigen::Vector3d(pose_sigma.data()).cwiseAbs2().asDiagonal();
}

LandmarkSlamNodeParams LandmarkSlamNodeParams::fromRos(const ros::NodeHandle& private_node) {
  LandmarkSlamNodeParams params;
  ParamReader reader(private_node);
  readFilter(reader, params);
  readLandmarks(reader, params);
  reader.read("cameras", params.cameras);
  reader.read("map_file", params.map_file);
  reader.read("marker_map_file", params.marker_map_file);
  reader.read("start", params.start);
  reader.read("start_pose", params.start_pose);
  reader.read("pose_sigma", params.pose_sigma);
  reader.read("map_frame", params.map_frame);
  reader.read("odom_frame", params.odom_frame);
  reader.read("base_frame", params.base_frame);
  reader.read("tf_output", params.tf_output);
  reader.read("transform_timeout", params.transform_timeout);
  reader.rejectUnknown();
  reader.validate(params);
  return params;
}

}  // namespace sextant
