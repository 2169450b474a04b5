// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/localization/odometry_correction.hpp"
#include "sextant/mapping/lens_correction.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// Parameters of adjustMap().
struct AdjustmentParams {
  double corner_sigma = 0.3;  ///< standard deviation of corner coordinates, common to all corners, pixels
  double robust_width = 0.0;  ///< width of a marker's Huber loss, standard deviations; 0: no robust loss
  double lens_sigma = 0.0;    ///< standard deviation of the coefficients of every LensCorrection, pixels
  double correlated_images = 1.0;  ///< number of consecutive images that count as one, see correlatedImages()
  std::optional<FloorPrior> floor;  ///< prior of every pose of the base
  OdometryParams odometry;          ///< noise of odometry between instants
  int threads = 1;                  ///< number of threads
};

/// A map, the path of the base and the errors of the cameras.
struct MapEstimate {
  MarkerMap map;                ///< poses of the markers
  BasePath T_map_base;          ///< poses of the base, one per instant
  LensCorrections lenses = {};  ///< errors of the cameras' calibrations
};

/// Bundle adjustment (Triggs et al. 2000) with Ceres: the poses of all markers and of the base at all
/// instants, and the errors of the cameras' calibrations, that minimize the reprojection error of the
/// corners.
/// @param used observations of markers in start.map, at instants with a pose in start
/// @param known markers that define the frame: with a covariance as a prior, without one as fixed poses
/// @param start initial values
/// @return the adjusted estimate; nothing if there are no observations or the minimization fails
std::optional<MapEstimate> adjustMap(const MarkerRecording& recording,
                                     const std::vector<RecordedObservation>& used, const MarkerMap& known,
                                     const MapEstimate& start, const AdjustmentParams& params);

/// Joint covariance of the markers' poses at a minimum, in the order of estimate.map.markers(), six rows per
/// marker: position, rotation in the map's axes; zero for fixed markers. Returns nothing if the observations
/// do not determine a pose. Parameters as for adjustMap().
std::optional<Eigen::MatrixXd> mapCovariance(const MarkerRecording& recording,
                                             const std::vector<RecordedObservation>& used,
                                             const MarkerMap& known, const MapEstimate& estimate,
                                             const AdjustmentParams& params);

}  // namespace sextant
