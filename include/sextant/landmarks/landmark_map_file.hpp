// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// A landmark map with its covariance and the last pose of the robot.
struct LandmarkMap {
  std::string frame = "map";          ///< tf frame of the map
  Pose2 T_map_base;                   ///< last pose of the robot
  std::vector<Landmark2D> landmarks;  ///< in the map frame
  std::vector<LandmarkLabel> labels;  ///< of each landmark
  Eigen::MatrixXd covariance;  ///< of (x, y, heading) of the robot and of the landmarks, as LandmarkFilter
  bool is_lost = false;        ///< whether the robot was lost: T_map_base is not valid then

  /// @throws std::invalid_argument if the sizes of landmarks, labels and covariance differ, a value is not
  /// finite, a frame or class is empty, an id occurs twice in a class, or the covariance is not positive
  /// semidefinite
  void validate() const;
};

/// Reads a map from YAML (doc/how_to/landmarks.md).
/// @throws std::runtime_error "file:line: reason" for anything unreadable, unknown or out of range
LandmarkMap readLandmarkMap(const std::string& path);

/// Writes a map atomically (temporary file, fsync, rename).
/// @throws std::invalid_argument as LandmarkMap::validate(), std::runtime_error if the file cannot be written
void writeLandmarkMap(const LandmarkMap& map, const std::string& path);

}  // namespace sextant
