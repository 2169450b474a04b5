// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// What an image leaves open about a pose.
struct PosePosterior {
  size_t best;          ///< index of the most probable hypothesis
  double probability;   ///< of the best
  Matrix6d covariance;  ///< second moment of (position, rotation) about the best, in the map's axes
};

struct PosteriorParams {
  double decided = 0.999999;  ///< probability from which the best hypothesis is taken as certain
  std::optional<FloorPrior> floor;
};

/// Moments of the distribution of the pose about its best hypothesis. Where this is decided, they are those
/// of its own neighbourhood; where not, of all hypotheses together, enlarged where the region called 95 %
/// (squared Mahalanobis distance below 12.59) would hold less than 92 % of them. Most images need no
/// enlargement and their regions hold more: over many images the region holds the truth in 95 % of them.
/// Where the pose may move so far on the arc about its markers that a Gaussian about the minimum misleads,
/// the distribution is summed over a lattice of tilts.
/// @param hypotheses of these sightings, not empty
PosePosterior posePosterior(const std::vector<MarkerSighting>& sightings,
                            const std::vector<PoseHypothesis>& hypotheses, const PosteriorParams& params);

}  // namespace sextant
