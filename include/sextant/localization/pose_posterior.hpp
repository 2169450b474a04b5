// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// Second moment of the posterior distribution of a pose.
struct PosePosterior {
  size_t best;          ///< index of the most probable hypothesis
  double probability;   ///< of the best hypothesis; at most 0.5 where two minima merge
  Matrix6d covariance;  ///< second moment of (position, rotation) about the best hypothesis, map's axes
};

/// Parameters of posePosterior().
struct PosteriorParams {
  double min_probability = 0.999999;  ///< minimum probability of an unambiguous hypothesis
  std::optional<FloorPrior> floor;    ///< prior of the base pose
};

/// Computes the second moment of the pose about the best hypothesis. If that is unambiguous, the moment is
/// that of its own minimum; otherwise that of all hypotheses, inflated if the 95 % region (squared
/// Mahalanobis distance below 12.59) contains less than 92 % of the probability. Most regions contain more,
/// so that over many images 95 % of the regions contain the true pose. Where the pose is uncertain along so
/// long an arc about its markers that a Gaussian is a poor approximation, the distribution is summed over a
/// grid of tilts (rotations about the two least certain axes).
/// @param hypotheses result of poseHypotheses() with these observations, not empty
PosePosterior posePosterior(const std::vector<MarkerObservation>& observations,
                            const std::vector<PoseHypothesis>& hypotheses, const PosteriorParams& params);

}  // namespace sextant
