// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/PoseWithCovariance.h>

#include <vector>

#include "sextant/LandmarkMapEntries.h"
#include "sextant/LandmarkObservations.h"
#include "sextant/MarkerArray.h"
#include "sextant/PlaceHypotheses.h"
#include "sextant/fusion/marker_landmarks.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/geometry/pose2.hpp"
#include "sextant/landmarks/landmark_hypotheses.hpp"

namespace sextant {

/// Pose in the plane z = 0.
Pose toPose(const Pose2& pose);

/// Planar pose of a sensor: x is the viewing direction, which is z of its frame if that is level (an optical
/// frame), else x.
Pose2 planarSensorPose(const Pose& T_base_frame);

/// Converts a planar pose. @param covariance of (x, y, heading); the other elements of the message are zero
geometry_msgs::PoseWithCovariance toPoseWithCovarianceMsg(const Pose2& pose,
                                                          const Eigen::Matrix3d& covariance);

/// Projects a pose to the plane.
/// @throws std::invalid_argument for a quaternion that is not of unit length (to 1 %) or a number that is not
/// finite
Pose2 planarFromMsg(const geometry_msgs::Pose& pose);

/// Projects a pose with covariance to the plane.
/// @throws std::invalid_argument as the pose alone, and if the covariance of (x, y, heading) is not positive
/// definite
PoseEstimate2D planarFromMsg(const geometry_msgs::PoseWithCovariance& estimate);

/// Converts observations to the robot frame. @param T_base_frame of the frame of the message; its z axis is
/// up
/// @throws std::invalid_argument that names the first invalid observation
std::vector<LabelledObservation> fromMsg(const LandmarkObservations& msg, const Pose& T_base_frame);

/// Converts markers to observations in the robot frame; skips markers without a size, whose pose is unknown.
/// @param map of the markers, or nullptr; see markerObservations()
/// @throws std::invalid_argument that names the first invalid marker
std::vector<LabelledObservation> fromMsg(const MarkerArray& msg, const Pose& T_base_camera,
                                         const MarkerLandmarkParams& params, const MarkerMap* map = nullptr);

/// Converts the places of an image to poses of the robot in the map; none if the image is not usable. A
/// place at which the heading is not known becomes several poses with different headings.
/// @param T_map_frame of the frame of the message
/// @throws std::invalid_argument that names the first invalid place
std::vector<PossiblePose> fromMsg(const PlaceHypotheses& msg, const Pose2& T_map_frame);

/// Converts all landmarks; the header is not set.
LandmarkMapEntries toMsg(const LandmarkSlam& slam);

}  // namespace sextant
