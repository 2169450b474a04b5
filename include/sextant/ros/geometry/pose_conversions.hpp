// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/Transform.h>

#include "sextant/geometry/pose.hpp"

namespace sextant {

geometry_msgs::Pose toPoseMsg(const Pose& pose);
geometry_msgs::Transform toTransformMsg(const Pose& pose);
geometry_msgs::PoseWithCovariance toPoseWithCovarianceMsg(const Pose& pose, const Matrix6d& covariance);

/// @throws std::invalid_argument for a quaternion whose norm differs from 1 by more than 1 %, or a number
/// that is not finite
Pose fromMsg(const geometry_msgs::Pose& pose);
Pose fromMsg(const geometry_msgs::Transform& transform);
Matrix6d fromMsg(const geometry_msgs::PoseWithCovariance::_covariance_type& covariance);

}  // namespace sextant
