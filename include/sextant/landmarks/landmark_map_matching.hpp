// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/observation_2d.hpp"

namespace sextant {

/// A landmark of a map with its marginal covariance.
struct MapPoint {
  Landmark2D landmark;         ///< position, and heading if it has one, in its map
  LandmarkLabel label;         ///< class or marker, as far as known
  Eigen::Matrix2d covariance;  ///< of its position, in the axes of its map
};

/// Parameters of the matching of two landmark maps.
struct LandmarkMapMatchingParams {
  double gate = 0.999;
  double min_probability = 0.9999;
  double inlier_probability = 0.8;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// Alignment of a local map with a map.
struct LandmarkMapMatch {
  Pose2 T_map_local;                             ///< pose of the local frame in the map
  std::vector<std::pair<size_t, size_t>> pairs;  ///< indices of the same landmark in local and in map
};

/// Finds a local map in a larger one. Pairs of landmarks with the same distance in both maps, and landmarks
/// with an id and a heading, generate pose hypotheses. A hypothesis is scored by a likelihood ratio:
/// how likely the local landmarks are if the pose is right, compared with landmarks at random positions.
/// @returns nothing if no hypothesis is significantly more likely than chance and than all others
std::optional<LandmarkMapMatch> matchLandmarkMaps(const std::vector<MapPoint>& local,
                                                  const std::vector<MapPoint>& map,
                                                  const LandmarkMapMatchingParams& params);

}  // namespace sextant
