// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "sextant/localization/odometry_correction.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

struct PathParams {
  double corner_sigma = 0.3;    ///< noise that all corner coordinates have in common, pixels
  HypothesesParams hypotheses;  ///< robust width, gate, floor
  OdometryParams odometry;      ///< how it drifts between instants
  double decided = 0.999;       ///< probability from which one of several poses is taken as certain
};

/// What explains one instant, the most probable first; empty where nothing does.
using InstantHypotheses = std::vector<PoseHypothesis>;

/// What explains the mapped markers of one instant.
/// @param prior what odometry says
/// @param without markers that do not count
InstantHypotheses locateInstant(const RecordedInstant& instant, const MarkerMap& map,
                                const PathParams& params, const std::optional<PosePrior>& prior,
                                const std::set<MarkerKey>& without = {});

/// The markers that PoseHypothesis::used counts, with the same arguments.
std::vector<MarkerKey> markersInSight(const RecordedInstant& instant, const MarkerMap& map,
                                      const PathParams& params, const std::set<MarkerKey>& without = {});

/// Where the base was at each instant of a recording, as far as a map tells: every pose that explains the
/// markers in sight. Odometry from the nearest instants that are certain decides where markers do not, and
/// stands in where there are none.
/// @param kept of instants that need not be located again; empty where they must
std::vector<InstantHypotheses> locateRecording(const MarkerRecording& recording, const MarkerMap& map,
                                               const PathParams& params,
                                               std::vector<InstantHypotheses> kept = {});

/// Whether the best is certain.
bool isDecided(const InstantHypotheses& hypotheses, double decided);

/// Whether the best can be taken for the pose: it is certain, or several markers agree on it.
bool isUsable(const InstantHypotheses& hypotheses, double decided);

}  // namespace sextant
