// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// A cell of the grid: the best pose with one tilt (rotation about the two least certain axes), and the
/// distribution of the other four degrees of freedom.
struct TiltCell {
  Pose T_map_base;
  Matrix6d covariance;  ///< of position, rotation in the map's axes with this tilt: rank 4
  double log_density;   ///< log of the cell's probability mass, up to a common constant
  double cost;          ///< minimum of the cost with this tilt
  size_t hypothesis;    ///< index of the minimum from which the cell was reached
};

/// A distribution of poses as a sum over cells.
struct TiltGrid {
  std::vector<TiltCell> cells;
  std::vector<size_t> group;  ///< group of each minimum; equal for minima without a cost barrier between them
};

/// Computes the distribution of the base pose from markers in one plane. It is not Gaussian: far from the
/// markers the base is on an arc about them, or on two arcs, one for each planar solution. The cells are a
/// grid of rotations about the two least certain axes. It is grown from the minima down to exp(-15) of the
/// peak; in each cell, the cost is minimized over the other four degrees of freedom, which are taken as
/// Gaussian.
/// @param minima minima of the observations' cost, all with the same markers; the first defines the axes
/// @return no cells if the minimization fails
TiltGrid tiltGrid(const std::vector<MarkerObservation>& observations,
                  const std::vector<PoseHypothesis>& minima, const std::optional<FloorPrior>& floor);

}  // namespace sextant
