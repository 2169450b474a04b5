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

/// A parameter block of Ceres: x y z of the position, x y z w of the quaternion.
using PoseBlock = std::array<double, 7>;

PoseBlock blockFromPose(const Pose& pose);
Pose poseFromBlock(const PoseBlock& block);

/// Cost of an observation: eight residuals over their standard deviations, as a function of T_map_base,
/// T_map_marker and the camera's LensCorrection.
/// @param camera not owned
std::unique_ptr<ceres::CostFunction> cornersCost(const CameraModel* camera, const Pose& T_camera_base,
                                                 double size, const Corners& corners,
                                                 const CornerSigmas& sigmas);

/// Cost of an odometry step: whitened error of T_map_a^-1 T_map_b, as a function of T_map_a and T_map_b.
std::unique_ptr<ceres::CostFunction> stepCost(const PosePrior& T_a_b);

/// Cost of a prior: whitened error of a pose.
std::unique_ptr<ceres::CostFunction> priorCost(const PosePrior& known);

/// Cost of the prior of a LensCorrection: coefficients over their standard deviation, pixels.
std::unique_ptr<ceres::CostFunction> lensCost(double sigma);

/// Cost of the floor prior: height, roll and pitch of the base over their standard deviations.
std::unique_ptr<ceres::CostFunction> floorCost(const FloorPrior& floor);

}  // namespace sextant
