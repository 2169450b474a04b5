// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <tuple>

namespace sextant {

/// Family and id of a marker. The family is canonical (see marker_family.hpp), so that a printed marker has
/// the same key with every detector backend.
struct MarkerKey {
  std::string family;  ///< name of the family, e.g. `tag36h11`
  int id = 0;          ///< number within the family
};

inline bool operator<(const MarkerKey& a, const MarkerKey& b) {
  return std::tie(a.family, a.id) < std::tie(b.family, b.id);
}
inline bool operator==(const MarkerKey& a, const MarkerKey& b) {
  return a.id == b.id && a.family == b.family;
}

/// Corners of a marker in the image, pixels: top left, top right, bottom right, bottom left of the upright
/// marker.
using Corners = std::array<Eigen::Vector2d, 4>;

/// Standard deviation of either coordinate of each corner, pixels; a value <= 0: unknown.
using CornerSigmas = std::array<double, 4>;

/// A marker detected in an image.
struct Detection {
  MarkerKey key;    ///< family and id
  Corners corners;  ///< (0, 0) is the centre of the first pixel
  /// Large for corners of occluded edges; -1: unknown, consumers use only their own `corner_sigma`.
  CornerSigmas corner_sigmas = {-1, -1, -1, -1};
  int hamming = -1;             ///< number of corrected bits; -1: not reported by the backend
  double decision_margin = -1;  ///< contrast of the bits, grey levels; -1: not reported by the backend
};

/// Corners of a marker in its own frame, metres: origin in the centre, x right and y up for a viewer, z out
/// of the wall toward the viewer.
/// @param size edge length, metres
std::array<Eigen::Vector3d, 4> markerCorners(double size);

Eigen::Vector2d centre(const Corners& corners);  ///< mean of the corners, pixels
double perimeter(const Corners& corners);        ///< pixels
double shortestSide(const Corners& corners);     ///< pixels

}  // namespace sextant
