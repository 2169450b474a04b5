// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/PoseWithCovariance.h>

#include <vector>

#include "sextant/LandmarkMapEntries.h"
#include "sextant/LandmarkSightings.h"
#include "sextant/MarkerArray.h"
#include "sextant/fusion/marker_landmarks.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/geometry/pose2.hpp"
#include "sextant/landmarks/landmark_slam.hpp"

namespace sextant {

/// In the plane z = 0.
Pose toPose(const Pose2& pose);

/// Where a sensor is and looks: along x, or along z where that is level, as of an optical frame.
Pose2 viewOf(const Pose& T_base_frame);
/// @param covariance of (x, y, heading) in the axes of the pose's frame; what is not of the plane is zero
geometry_msgs::PoseWithCovariance toPoseWithCovarianceMsg(const Pose2& pose,
                                                          const Eigen::Matrix3d& covariance);

/// Seen from above. @throws std::invalid_argument for a quaternion that is not of unit length (to 1 %) or a
/// number that is not finite
Pose2 planarFromMsg(const geometry_msgs::Pose& pose);
/// @throws std::invalid_argument as the pose alone, and for a covariance of x, y and heading that is not
/// positive definite
PlanePoseEstimate planarFromMsg(const geometry_msgs::PoseWithCovariance& estimate);

/// In the robot frame. @param T_base_frame of the message's frame, whose z is up
/// @throws std::invalid_argument that names the first sighting that cannot be
std::vector<LabelledSighting> fromMsg(const LandmarkSightings& msg, const Pose& T_base_frame);

/// In the robot frame; markers without a size are left out: their pose is not known.
/// @throws std::invalid_argument that names the first marker that cannot be
std::vector<LabelledSighting> fromMsg(const MarkerArray& msg, const Pose& T_base_camera,
                                      const MarkerLandmarkParams& params);

/// All landmarks; the header is left out.
LandmarkMapEntries toMsg(const LandmarkSlam& slam);

}  // namespace sextant
