// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// What was measured on drives among landmarks, with the landmark of each observation.
struct LandmarkDrives {
  /// Odometry between two poses.
  struct Step {
    size_t before;          ///< index of the pose at its beginning; it ends at the next pose
    OdometryStep odometry;  ///< motion with its noise
    bool may_slip;          ///< whether the robot may have been carried away
  };
  /// An observation of a landmark.
  struct Sighting {
    size_t pose;                ///< its index
    size_t landmark;            ///< its index
    Observation2D observation;  ///< in the robot frame
    Pose2 T_base_sensor;        ///< about which the bearing turns
  };
  std::vector<Step> steps;              ///< of all drives
  std::vector<Sighting> sightings;      ///< of all drives
  std::optional<Pose2> first_pose;      ///< T_map_base at the first pose, if it was known
  std::vector<Landmark2D> known;        ///< first landmarks, as they were known before
  Eigen::MatrixXd covariance_of_known;  ///< of first_pose, if there is one, and known
};

/// Drives and map that were estimated together.
struct AdjustedLandmarks {
  std::vector<Pose2> poses;           ///< T_map_base
  std::vector<Landmark2D> landmarks;  ///< in the map frame
  double scale = 1;                   ///< as LandmarkFilter::scale()
  double turn_scale = 1;              ///< as LandmarkFilter::turnScale()
  double bearing = 0;                 ///< as LandmarkFilter::bearing()
  Eigen::MatrixXd covariance;         ///< of the last pose and the landmarks
};

/// The most probable poses and landmarks (Dellaert and Kaess 2006, "Square root SAM"), with robust losses:
/// gross errors of sightings count less, and so do steps at which the robot was carried away.
/// @param params standard deviations of scales and bearing; 0: not estimated
/// @param begin where the search begins
/// @throws std::runtime_error if the measurements do not determine all poses and landmarks
AdjustedLandmarks adjustLandmarks(const LandmarkDrives& measured, const LandmarkFilterParams& params,
                                  const AdjustedLandmarks& begin);

}  // namespace sextant
