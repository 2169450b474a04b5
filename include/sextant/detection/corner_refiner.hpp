// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "sextant/geometry/camera.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// The outer square of a marker.
struct BorderSquare {
  int modules = 8;            ///< width in modules; edges are searched at most one module to either side
  bool white_inside = false;  ///< some AprilTag families are white inside their edge and black around it
  double start_sigma = 1;  ///< standard deviation of the initial corner coordinates without occlusion, pixels
};

/// Refined corners of a marker.
struct RefinedCorners {
  Corners corners;      ///< pixels; initial corners where the refinement failed
  CornerSigmas sigmas;  ///< standard deviation of either coordinate, pixels, > 0
};

/// Refines corners to subpixel accuracy. The edges of the square are located on every image line that crosses
/// them, a curve is fitted to each edge, and adjacent curves are intersected.
///
/// Lens distortion: with a camera, the image of a straight line in space is fitted, so that the corners are
/// those of straight lines in the undistorted image. Without a camera, or outside its lens model, an edge is
/// a straight line, or a parabola if it is long enough to show the curvature.
///
/// Noise: the offset of an edge at its end s has the variance v = r' (X'X)^-1 r sigma^2, where r = (1, s[,
/// s^2]), the rows of X are the r of the samples, and sigma^2 is the variance of the residuals, increased if
/// neighbours are correlated. The corner p of edges with unit normals a and b solves (a b)' dp = (offsets),
/// so that
///   covariance = N^-1 diag(v_a, v_b) N^-T, N = (a b)'.
/// The variance of the corner is half its trace. Errors that residuals do not show are added: to each v, (0.3
/// w exp(-m / 2w))^2 for the steps of adjacent modules of m pixels under a blur of w pixels; to the variance
/// of the corner, 0.015^2 px^2 for the shape of lens and marker.
///
/// Occlusion: a corner is only refined from two edges that are at least half visible and one module away from
/// the bits inside. The edge of an occluder is at another distance, which is detected from errors of 0.35 px
/// and 0.12 modules on if the code has steps near the edge. If one edge is occluded and the camera is known,
/// its corners follow from the other three edges: two corners and the edges through the others determine the
/// square's pose (see occluded_edge.hpp). 0.15 px are added in quadrature to the sigmas of the visible edges
/// and corners, because extrapolation amplifies their systematic errors. Otherwise the initial corner is
/// returned; its sigma then contains the possible error of the edge.
/// @param image 8-bit grey
/// @param corners initial corners, clockwise in the image, with errors up to 6 px or five of their standard
/// deviations, but at most nine tenths of a module
RefinedCorners refineCorners(const cv::Mat& image, const Corners& corners, const BorderSquare& square,
                             const CameraModel* camera = nullptr);

}  // namespace sextant
