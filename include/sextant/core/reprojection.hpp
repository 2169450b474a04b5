// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/core/camera.hpp"
#include "sextant/core/pose.hpp"

namespace sextant {

/// A point of known place seen at a pixel by a camera that is mounted on a base.
struct Sighting {
  const CameraModel* camera;  ///< not owned
  Pose T_camera_base;
  Eigen::Vector3d p_map;  ///< metres
  Eigen::Vector2d pixel;
};

struct ReprojectionParams {
  double sigma = 0.3;         ///< noise of a pixel coordinate
  double robust_width = 1e9;  ///< Huber: residuals longer than this many sigma count less
};

struct ReprojectionFit {
  Pose T_map_base;
  double cost;           ///< sum of rho(|residual|^2 / sigma^2)
  double rms;            ///< over all coordinates, pixels
  Matrix6d information;  ///< of (position, rotation) in the map's axes, with the robust weights
};

/// Robust cost of a pose: Huber's rho, rho(s) = s for s <= w^2, else 2 w sqrt(s) - w^2. A point that the lens
/// does not reach from there counts as far off.
double reprojectionCost(const std::vector<Sighting>& sightings, const Pose& T_map_base,
                        const ReprojectionParams& params);

/// The pose that minimizes the robust reprojection cost, by Levenberg-Marquardt over six parameters (p + dp,
/// Exp(dr) R). Nothing where the start or the points leave the pose undetermined.
std::optional<ReprojectionFit> minimizeReprojection(const std::vector<Sighting>& sightings, const Pose& start,
                                                    const ReprojectionParams& params);

}  // namespace sextant
