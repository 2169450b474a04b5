// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// Landmarks with all that is known of them, and of where the robot was.
struct LandmarkMap {
  std::string frame = "map";
  Pose2 T_map_base;
  std::vector<PlaneLandmark> landmarks;
  std::vector<LandmarkLabel> labels;  ///< one for each
  Eigen::MatrixXd
      covariance;        ///< of (x, y, heading) of the robot, then of the landmarks, as LandmarkFilter's
  bool is_lost = false;  ///< the robot is not where T_map_base says

  /// @throws std::invalid_argument where numbers of landmarks, labels and rows do not fit, a value is not
  /// finite, a frame or class has no name, an id is there twice, or the covariance is none
  void validate() const;
};

/// Reads YAML (doc/landmarks.md). Nothing is taken from a file with a mistake in it.
/// @throws std::runtime_error "file:line: reason" for anything unreadable, unknown or out of range
LandmarkMap readLandmarkMap(const std::string& path);

/// Writes atomically (temporary file, fsync, rename).
/// @throws std::invalid_argument as LandmarkMap::validate(), std::runtime_error when the file cannot be
/// written
void writeLandmarkMap(const LandmarkMap& map, const std::string& path);

}  // namespace sextant
