// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "sextant/fusion/marker_landmarks.hpp"
#include "sextant/landmarks/landmark_slam.hpp"
#include "sextant/landmarks/landmark_timeline.hpp"

namespace sextant {

/// Parameters of the nodelet sextant/LandmarkSlam.
struct LandmarkSlamNodeParams {
  LandmarkSlamParams slam;          ///< of filter and data association
  LandmarkTimelineParams timeline;  ///< of the buffer of late measurements
  MarkerLandmarkParams markers;     ///< of markers as landmarks
  std::vector<std::string> cameras;
  std::string places;
  std::string map_file;
  std::string marker_map_file;
  std::string start = "origin";
  std::vector<double> start_pose;
  std::vector<double> pose_sigma = {0.001, 0.001, 0.001};
  std::string map_frame = "map";
  std::string odom_frame;
  std::string base_frame;
  std::string tf_output = "none";
  std::string initialpose = "never";
  double transform_timeout = 0.1;

  ParamList fields();                       ///< names, ranges, units and descriptions
  Pose2 startPose() const;                  ///< T_map_base of start_pose
  Eigen::Matrix3d startCovariance() const;  ///< of (x, y, heading), from pose_sigma
};

}  // namespace sextant
