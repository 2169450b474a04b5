// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>

#include <array>
#include <memory>

#include "sextant/mapping/landmark_adjustment.hpp"

namespace sextant {

/// A parameter block of Ceres: x, y, heading of a pose, or x, y[, heading] of a landmark.
using PlanarBlock = std::array<double, 3>;

/// Whitened error of an odometry step, as a function of the poses at its ends, scale and turn scale.
std::unique_ptr<ceres::CostFunction> planarStepCost(const OdometryStep& step);

/// Whitened error of a sighting, as a function of the pose, the landmark and the bearing.
std::unique_ptr<ceres::CostFunction> sightingCost(const LandmarkDrives::Sighting& sighting,
                                                  const Landmark2D& landmark);

/// Error of a single value over its standard deviation.
std::unique_ptr<ceres::CostFunction> valueCost(double expected, double sigma);

/// Whitened error of what was known before, as a function of first_pose, if there is one, and known.
std::unique_ptr<ceres::CostFunction> knownLandmarksCost(const LandmarkDrives& measured);

}  // namespace sextant
