// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// The pose predicted before an image: the last pose, moved by odometry.
struct PosePrior {
  Pose T_map_base;      ///< expected pose of the base in the map
  Matrix6d covariance;  ///< position, rotation in the map's axes
};

/// Initial value of a minimization: the base pose computed from one of the observations.
struct InitialPose {
  Pose T_map_base;     ///< pose of the base in the map
  size_t observation;  ///< index of the observation
};

/// A base pose that explains the observations.
struct PoseHypothesis {
  Pose T_map_base;      ///< pose of the base in the map
  Matrix6d covariance;  ///< position, rotation in the map's axes
  double cost;  ///< squared Mahalanobis distances of markers and floor prior, plus 100 for each outlier
  double rms;   ///< RMS reprojection error of the markers used, pixels
  std::vector<size_t> used;  ///< indices of the observations within the gate
  double log_prior;          ///< log density of the prior at the pose; 0 without a prior
  double weight;             ///< probability among the hypotheses
};

/// Parameters of poseHypotheses().
struct HypothesesParams {
  double robust_width = 5.0;  ///< width of the Huber loss in the first minimization, standard deviations
  double gate = 30.0;         ///< squared Mahalanobis distance beyond which a marker is an outlier
  std::optional<FloorPrior> floor;  ///< prior of the base pose
};

/// Finds local minima of the reprojection cost, the most probable first. Each minimum is computed without the
/// markers outside its gate. Its probability is Laplace's approximation, exp(-cost / 2) sqrt(det covariance),
/// times the density of the prior. Empty if no minimum explains any marker.
/// @param prior only weights the hypotheses, does not change their poses
std::vector<PoseHypothesis> poseHypotheses(const std::vector<MarkerObservation>& observations,
                                           const std::vector<InitialPose>& initial_poses,
                                           const HypothesesParams& params,
                                           const std::optional<PosePrior>& prior);

}  // namespace sextant
