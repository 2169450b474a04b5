// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "edge_curve.hpp"
#include "sextant/geometry/camera.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// An occluded edge of a square, between its corners first_corner and first_corner + 1, and the visible rest.
struct OccludedEdge {
  int first_corner;
  EdgeCurve before, after;              ///< the adjacent edges, which end and begin at the occluded corners
  double before_sigma, after_sigma;     ///< standard deviation of these at the occluded corners, pixels
  std::array<double, 4> corner_sigmas;  ///< of the two visible corners, pixels
};

/// The corners of an occluded edge.
struct ReconstructedEdge {
  std::array<Eigen::Vector2d, 2> corners;  ///< begin and end, pixels
  std::array<double, 2> sigmas;            ///< standard deviation of their coordinates, pixels
};

/// Computes an occluded edge. The camera's pose relative to the square has six unknowns; two corners and the
/// two edges through the others give six equations. The deviations are those of the corners over the sigma
/// points of the pose (Julier and Uhlmann 1997), because nearly head-on the edge moves with the square of the
/// tilt. Returns nothing if the equations have no solution near the start.
/// @param corners of the square; the occluded ones are initial values
std::optional<ReconstructedEdge> reconstructEdge(const CameraModel& camera, const Corners& corners,
                                                 const OccludedEdge& edge);

}  // namespace sextant
