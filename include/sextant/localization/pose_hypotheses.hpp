// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// What is known of a pose before the image: the last one, moved by odometry.
struct PosePrior {
  Pose T_map_base;
  Matrix6d covariance;  ///< position, rotation in the map's axes
};

/// Where a search begins: a base pose that one of the sightings suggests.
struct PoseStart {
  Pose T_map_base;
  size_t sighting;  ///< index
};

/// One explanation of what the cameras see.
struct PoseHypothesis {
  Pose T_map_base;
  Matrix6d covariance;       ///< position, rotation in the map's axes
  double cost;               ///< squared Mahalanobis distance of all residuals; a marker left out costs 100
  double rms;                ///< reprojection error of the markers used, pixels
  std::vector<size_t> used;  ///< indices of the sightings that it explains
  double log_prior;          ///< what the prior says of it, logarithm of a density; 0 without a prior
  double weight;             ///< probability among the hypotheses
};

struct HypothesesParams {
  double robust_width =
      5.0;  ///< of the first search: a marker farther off than so many sigma (of 8 dimensions) counts less
  double gate = 30.0;  ///< squared Mahalanobis distance of a marker beyond which a hypothesis leaves it out
  std::optional<FloorPrior> floor;
};

/// The local minima of the reprojection cost that the starts lead to, the most probable first. Each leaves
/// out the markers beyond the gate. Probabilities are Laplace's: exp(-cost / 2) sqrt(det covariance), times
/// what the prior says of the pose. Empty where no start leads to a pose that explains a marker.
std::vector<PoseHypothesis> poseHypotheses(const std::vector<MarkerSighting>& sightings,
                                           const std::vector<PoseStart>& starts,
                                           const HypothesesParams& params,
                                           const std::optional<PosePrior>& prior);

}  // namespace sextant
