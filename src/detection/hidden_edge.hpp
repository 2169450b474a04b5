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

/// An edge of a square between its corners hidden and hidden + 1, which is not seen.
struct HiddenEdge {
  int hidden;
  EdgeCurve before, after;              ///< the edges that end and begin there
  double before_sigma, after_sigma;     ///< pixels, of these where they end and begin
  std::array<double, 4> corner_sigmas;  ///< pixels, of both other corners
};

struct FoundEdge {
  std::array<Eigen::Vector2d, 2> corners;  ///< where it begins and ends, pixels
  std::array<double, 2> sigmas;            ///< of their coordinates, pixels
};

/// Where the edge must be: the camera's pose before the square has six unknowns, and two corners and two
/// edges through the others are six equations. The deviations are those of the corners over the pose's sigma
/// points (Julier and Uhlmann 1997), since nearly head-on a tilt moves the edge by its square. Nothing where
/// the equations have no solution near the start.
/// @param corners the hidden ones: a start
std::optional<FoundEdge> findHidden(const CameraModel& camera, const Corners& corners,
                                    const HiddenEdge& edge);

}  // namespace sextant
