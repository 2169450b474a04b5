// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "sextant/geometry/camera.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// The square whose corners are looked for.
struct BorderSquare {
  int modules = 8;            ///< its width; an edge is searched no farther than a module to either side
  bool white_inside = false;  ///< some AprilTag families are white inside their edge and black around it
  double start_sigma = 1;     ///< of the start's coordinates where nothing hides the edges, pixels
};

struct RefinedCorners {
  Corners corners;      ///< pixels; where nothing better was found, the start's
  CornerSigmas sigmas;  ///< of either coordinate, pixels, > 0
};

/// Corners at subpixel. The square's edges are found on every image line that crosses them, a line is fitted
/// to each, neighbours are intersected.
///
/// The lens: with a camera, what is fitted is the image of a straight line in space, so that the corners are
/// those of straight lines in the undistorted image. Without one, or where its lens model has no rays, an
/// edge is straight, or a parabola where it is long enough to show a lens's curvature.
///
/// The noise: an edge's offset at its end s has the variance v = r' (X'X)^-1 r s^2, where r = (1, s[, s^2])
/// and s^2 is the scatter of the edge's samples about its line, more where neighbours resemble each other:
/// they then tell less than their number. The corner p of edges with unit normals a and b solves (a b)' dp =
/// (offsets), so that
///   covariance = N^-1 diag(v_a, v_b) N^-T, N = (a b)',
/// and the corner's variance is half its trace, plus that of what no scatter shows: each v has (0.3 b exp(-m
/// / 2b))^2 for the steps of neighbouring modules of m pixels under a blur of b, and the corner 0.015 px for
/// the shape of lens and print.
///
/// What is hidden: a corner is only refined from two edges of which at least half is seen, and which lie a
/// module away from the bits inside, as an occluder's edge does not (seen from 0.35 px and 0.12 modules
/// on, where the code has steps near it). Where one edge is hidden and the camera is known, its corners are
/// told by the other three: a square's pose follows from two corners and the edges through the others (see
/// hidden_edge.hpp); first 0.15 px are added to what is seen, since what lens and print move it by is drawn
/// out, too. Else the start's is told, with its own sigma and the edge's doubt.
/// @param image 8-bit grey
/// @param corners start, clockwise in the image, good to 6 px or five of its deviations, but at most to
/// nine tenths of a module
RefinedCorners refineCorners(const cv::Mat& image, const Corners& corners, const BorderSquare& square,
                             const CameraModel* camera = nullptr);

}  // namespace sextant
