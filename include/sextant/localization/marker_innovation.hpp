// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "sextant/geometry/pose.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// Innovation of a marker: its observation compared with the pose that the other markers determine.
struct MarkerInnovation {
  double squared_distance;       ///< squared Mahalanobis distance of the eight corner coordinates
  Eigen::Vector3d p_map;         ///< observed position of the marker's centre in the map, metres
  Eigen::Matrix3d p_covariance;  ///< covariance of p_map, m^2
};

/// Computes the innovation of a marker, compared with the pose that the other markers determine.
/// @param T_camera_marker pose of the marker, computed from its corners alone
/// @param pose from all markers used, perhaps with this one
/// @param used whether the marker contributed to the pose
/// @return nothing if the other markers do not determine a pose
std::optional<MarkerInnovation> markerInnovation(const MarkerObservation& observation,
                                                 const Pose& T_camera_marker, const PoseHypothesis& pose,
                                                 bool used);

}  // namespace sextant
