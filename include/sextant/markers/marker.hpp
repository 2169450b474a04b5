// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <tuple>

namespace sextant {

/// Which print it is. The family is canonical (see marker_family.hpp): one print has one key, whatever
/// backend reads it.
struct MarkerKey {
  std::string family;
  int id = 0;
};

inline bool operator<(const MarkerKey& a, const MarkerKey& b) {
  return std::tie(a.family, a.id) < std::tie(b.family, b.id);
}
inline bool operator==(const MarkerKey& a, const MarkerKey& b) {
  return a.id == b.id && a.family == b.family;
}

/// Corners of a marker in the order top left, top right, bottom right, bottom left of the upright print.
using Corners = std::array<Eigen::Vector2d, 4>;

/// A standard deviation for every corner, pixels; not positive where nothing is known.
using CornerSigmas = std::array<double, 4>;

/// A marker found in an image.
struct Detection {
  MarkerKey key;
  Corners corners;  ///< pixels; (0, 0) is the centre of the first pixel
  /// Standard deviation of either coordinate of each corner, pixels, large where something hides the edges;
  /// -1: unknown, then who uses the corner knows its own `corner_sigma`.
  CornerSigmas corner_sigmas = {-1, -1, -1, -1};
  int hamming = -1;  ///< corrected bits; -1: the backend does not tell
  double decision_margin =
      -1;  ///< contrast of the bits against their threshold; -1: the backend does not tell
};

/// The corners of a marker of this edge length (metres) in its own frame: origin in the centre, x right and y
/// up as one looks at the print, z out of the wall toward the viewer.
std::array<Eigen::Vector3d, 4> markerCorners(double size);

/// Of a marker in an image: pixels.
Eigen::Vector2d centre(const Corners& corners);
double perimeter(const Corners& corners);
double shortestSide(const Corners& corners);

}  // namespace sextant
