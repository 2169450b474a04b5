// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/plane_sighting.hpp"

namespace sextant {

/// A landmark of a map, with what is not known of it alone.
struct MapPoint {
  PlaneLandmark landmark;
  LandmarkLabel label;
  Eigen::Matrix2d covariance;  ///< of its position, map's axes
};

struct LandmarkMatchingParams {
  double gate = 0.999;
  double certainty = 0.9999;
  double present = 0.8;

  ParamList fields();
};

/// Which landmarks of two maps are one.
struct LandmarkMatch {
  Pose2 T_map_local;
  std::vector<std::pair<size_t, size_t>> pairs;  ///< of local, of map
};

/// Where a small map lies in a large one. Every two landmarks of the small one that lie as far apart as two
/// of the large one are tried, and so is every one with an id and a heading; each hypothesis is weighed by
/// the likelihood of all landmarks of the small map against that of landmarks strewn at random.
/// @returns nothing where no hypothesis is far likelier than chance and than every other
std::optional<LandmarkMatch> matchLandmarks(const std::vector<MapPoint>& local,
                                            const std::vector<MapPoint>& map,
                                            const LandmarkMatchingParams& params);

}  // namespace sextant
