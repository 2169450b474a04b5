// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/landmarks/odometry_steps.hpp"
#include "sextant/landmarks/plane_sighting.hpp"

namespace sextant {

/// One instant of a drive that is known as a whole.
struct DriveMoment {
  OdometryStep step;  ///< since the moment before; nothing of it counts at the first one
  std::vector<KnownSighting> seen;
};

/// Where the robot was at every moment, and where the landmarks are.
struct DriveEstimate {
  std::vector<Pose2> T_map_base;
  std::vector<PlaneLandmark> landmarks;
};

struct SmoothedDrive {
  DriveEstimate estimate;
  double cost = 0;  ///< half the sum of the squared whitened residuals
};

/// The most probable drive and map by all steps and sightings at once (Dellaert and Kaess 2006, "Square root
/// SAM"), by Ceres. The first pose stays where it is.
/// @param start where the search begins: a pose for every moment
/// @returns nothing where the search fails
/// @throws std::invalid_argument where poses and moments are not as many, a sighting's landmark is not there,
/// or a covariance is not positive definite
std::optional<SmoothedDrive> smoothDrive(const std::vector<DriveMoment>& drive, const DriveEstimate& start);

}  // namespace sextant
