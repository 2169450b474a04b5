// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "sextant/fusion/marker_landmarks.hpp"
#include "sextant/landmarks/landmark_slam.hpp"
#include "sextant/landmarks/landmark_timeline.hpp"
#include "sextant/ros/base/param_reader.hpp"

namespace sextant {

/// Parameters of the nodelet sextant/LandmarkSlam.
struct LandmarkSlamNodeParams {
  LandmarkSlamParams slam;
  LandmarkTimelineParams timeline;
  MarkerLandmarkParams markers;
  std::vector<std::string> cameras;  ///< topics of sextant/MarkerArray, one a camera
  std::string map_file;            ///< landmark map: read at the start where it exists, written by ~save_map
  std::string marker_map_file;     ///< where printed markers hang; empty: marker_map/entries, if it comes
  std::string start = "origin";    ///< where the robot is in map_file: origin (start_pose) | map | unknown
  std::vector<double> start_pose;  ///< x, y, heading in the map, metres and radians; empty: 0 0 0
  std::vector<double> pose_sigma = {0.001, 0.001, 0.001};  ///< its deviations, metres and radians, (0, 1000]
  std::string map_frame = "map";   ///< of a map that is begun; one that is read has its own
  std::string odom_frame;          ///< empty: odometry's frame_id
  std::string base_frame;          ///< empty: odometry's child_frame_id
  std::string tf_output = "none";  ///< none | map_to_odom | map_to_base
  double transform_timeout = 0.1;  ///< how long a missing transform is waited for, seconds, [0, 10]

  /// @throws std::invalid_argument that names the first field out of range
  void validate() const;
  Pose2 startPose() const;                  ///< T_map_base
  Eigen::Matrix3d startCovariance() const;  ///< of (x, y, heading)
  /// Reads all from a node's private namespace, refuses unknown names and validates.
  static LandmarkSlamNodeParams fromRos(const ros::NodeHandle& private_node);
};

}  // namespace sextant
