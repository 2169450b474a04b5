// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <array>
#include <memory>

#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/marker.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// A pose as Ceres has it: x y z of the position, x y z w of the quaternion.
using PoseBlock = std::array<double, 7>;

PoseBlock blockFromPose(const Pose& pose);
Pose poseFromBlock(const PoseBlock& block);

/// A marker's eight residuals over their deviations, from the blocks of T_map_base and T_map_marker.
/// @param camera not owned
std::unique_ptr<ceres::CostFunction> cornersCost(const CameraModel* camera, const Pose& T_camera_base,
                                                 double size, const Corners& corners,
                                                 const CornerSigmas& sigmas);

/// Whitened error of T_map_a's inverse times T_map_b against what is measured of it, from both blocks.
std::unique_ptr<ceres::CostFunction> stepCost(const PosePrior& T_a_b);

/// Whitened error of a pose against what is known of it.
std::unique_ptr<ceres::CostFunction> priorCost(const PosePrior& known);

/// Height, roll and pitch of a base over their deviations.
std::unique_ptr<ceres::CostFunction> floorCost(const FloorPrior& floor);

}  // namespace sextant
