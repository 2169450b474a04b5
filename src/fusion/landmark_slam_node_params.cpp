// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/landmark_slam_node_params.hpp"

#include <stdexcept>

namespace sextant {
namespace {

void requireThree(const Param& param) {
  const size_t count = std::get<std::vector<double>*>(param.value)->size();
  if (count != 3)
    throw std::invalid_argument(param.name + " has " + std::to_string(count) +
                                " numbers, it must have three: x, y (m) and heading (rad)");
}

void requirePose(const Param& param) {
  if (std::get<std::vector<double>*>(param.value)->empty()) return;
  requireThree(param);
  Allowed(Range::closed(-1e9, 1e9)).check(param);
}

void requireSigmas(const Param& param) {
  requireThree(param);
  Allowed(Range::openLow(0, 1000)).check(param);
}

void requireDifferent(const std::string& name, const std::string& frame, const std::string& other) {
  if (!frame.empty() && frame == other)
    throw std::invalid_argument(name + " is '" + frame + "': map, odometry and base need different frames");
}

}  // namespace

ParamList LandmarkSlamNodeParams::fields() {
  const auto require_odom = [this](const Param&) { requireDifferent("map_frame", map_frame, odom_frame); };
  const auto require_base = [this](const Param&) {
    requireDifferent("map_frame", map_frame, base_frame);
    requireDifferent("odom_frame", odom_frame, base_frame);
  };
  const ParamList own = {
      {"map_file", &map_file, Allowed(), "",
       "landmark map file: read at start-up if it exists, written by `~save_map`"},
      {"start", &start, oneOf({"origin", "map", "unknown"}), "",
       "initial pose of the robot if `map_file` is read: origin (`start_pose`), map (the saved pose), or "
       "unknown (until it is relocalized)"},
      {"start_pose", &start_pose, Allowed("empty or 3", requirePose), "m, m, rad",
       "x, y, heading in the map; empty: 0 0 0, but with a marker map the robot is lost until it observes a "
       "marker"},
      {"pose_sigma", &pose_sigma, Allowed("3, each (0, 1000]", requireSigmas), "m, m, rad",
       "standard deviations of `start_pose`"},
      {"cameras", &cameras, topics(), "", "topics of sextant/MarkerArray, one per camera, e.g. `[markers]`"},
      {"places", &places, Allowed(), "",
       "topic of sextant/PlaceHypotheses, e.g. `places/hypotheses`: the recognized places relocalize a lost "
       "robot; empty: no topic"},
      {"marker_map_file", &marker_map_file, Allowed(), "",
       "[marker map](marker_map.md) file; empty: the topic `marker_map/entries`, if published"},
      {"map_frame", &map_frame, notEmpty(), "", "frame of a new map; a map file has its own"},
      {"odom_frame", &odom_frame, Allowed("not `map_frame`", require_odom), "",
       "odometry frame; empty: the `frame_id` of odometry"},
      {"base_frame", &base_frame, Allowed("not `map_frame`, not `odom_frame`", require_base), "",
       "frame of the robot whose pose is published; empty: the `child_frame_id` of odometry"},
      {"tf_output", &tf_output, oneOf({"none", "map_to_odom", "map_to_base"}), "",
       "[transform to publish](frames.md#tf_output)"},
      {"initialpose", &initialpose, oneOf({"never", "relocalized"}), "",
       "`relocalized`: publish the first pose, and the first one after the robot was lost, on `initialpose`"},
      {"transform_timeout", &transform_timeout, Range::closed(0, 10), "s",
       "maximum time to wait for a missing transform"},
  };
  return joined({own, timeline.fields(), slam.fields(), markers.fields()});
}

Pose2 LandmarkSlamNodeParams::startPose() const {
  return start_pose.empty() ? Pose2{} : Pose2{{start_pose[0], start_pose[1]}, wrapped(start_pose[2])};
}

Eigen::Matrix3d LandmarkSlamNodeParams::startCovariance() const {
  return Eigen::Vector3d(pose_sigma.data()).cwiseAbs2().asDiagonal();
}

}  // namespace sextant
