// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/localization/odometry_correction.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

struct AdjustmentParams {
  double corner_sigma = 0.3;  ///< noise that all corner coordinates have in common, pixels
  double robust_width = 0.0;  ///< Huber: a marker farther off than so many sigma (of 8 dimensions) counts
                              ///< less; 0: all count as they are
  double correlated_images = 1.0;   ///< so many images in a row say as much as one, see correlatedImages()
  std::optional<FloorPrior> floor;  ///< what is known of every pose of the base
  OdometryParams odometry;          ///< how it drifts between instants
  int threads = 1;
};

/// A map that fits a recording, or begins to.
struct MapEstimate {
  MarkerMap map;
  BasePath T_map_base;
};

/// Poses of all markers and of the base at all instants that minimize the reprojection error of the
/// sightings' corners (bundle adjustment, Triggs et al. 2000), by Ceres.
/// @param used every one of a marker that start.map has, at an instant whose pose start knows
/// @param known markers that hold the frame: those with a covariance are drawn to their place by it, those
/// without stay there
/// @param start where the search begins
/// @return start with the poses changed. Nothing where nothing is to be done, or where the search fails.
std::optional<MapEstimate> adjustMap(const MarkerRecording& recording,
                                     const std::vector<RecordedSighting>& used, const MarkerMap& known,
                                     const MapEstimate& start, const AdjustmentParams& params);

/// Covariance of the markers' poses at a minimum, in the order of estimate.map.markers(), six rows a marker:
/// position, rotation in the map's axes; zero for those that were held. Nothing where the sightings leave a
/// pose undetermined. Parameters as of adjustMap().
std::optional<Eigen::MatrixXd> mapCovariance(const MarkerRecording& recording,
                                             const std::vector<RecordedSighting>& used,
                                             const MarkerMap& known, const MapEstimate& estimate,
                                             const AdjustmentParams& params);

}  // namespace sextant
