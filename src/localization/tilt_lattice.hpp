// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// A piece of the distribution of poses: the best pose of one tilt, and how the rest scatters about it.
struct TiltCell {
  Pose T_map_base;
  Matrix6d
      covariance;      ///< of the other four degrees of freedom: position, rotation in the map's axes; rank 4
  double log_density;  ///< up to a common constant
  double cost;         ///< of the minimum, squared deviations
  size_t hypothesis;   ///< whose minimum it belongs to
};

struct TiltLattice {
  std::vector<TiltCell> cells;
  std::vector<size_t> group;  ///< of each minimum: those that no barrier parts have the same
};

/// The distribution of a pose that one plane of markers leaves, for which an ellipsoid is no picture: from
/// afar the base lies on an arc about the markers, or on two, one for each planar solution. Over a lattice of
/// the two weakest rotations, grown from the minima down to exp(-kDepth / 2) of the peak, the other four
/// degrees of freedom are minimized and taken as Gaussian.
/// @param minima of the sightings' cost, the first gives the lattice; all explain the same markers
/// @return without cells where the lattice finds no density
TiltLattice tiltLattice(const std::vector<MarkerSighting>& sightings,
                        const std::vector<PoseHypothesis>& minima, const std::optional<FloorPrior>& floor);

}  // namespace sextant
