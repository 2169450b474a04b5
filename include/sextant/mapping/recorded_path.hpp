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

/// Parameters of the localization of a recording.
struct PathParams {
  double corner_sigma = 0.3;    ///< standard deviation of corner coordinates, common to all corners, pixels
  HypothesesParams hypotheses;  ///< robust width, gate, floor
  OdometryParams odometry;      ///< noise of odometry between instants
  double min_probability = 0.999;  ///< minimum probability of an unambiguous pose
};

/// Pose hypotheses of the base at one instant, the most probable first; empty if there are none.
using InstantHypotheses = std::vector<PoseHypothesis>;

/// Locates the base at one instant from the mapped markers, the largest in the image if there are many.
/// @param prior prediction from odometry
/// @param without markers that are not used
InstantHypotheses locateInstant(const RecordedInstant& instant, const MarkerMap& map,
                                const PathParams& params, const std::optional<PosePrior>& prior,
                                const std::set<MarkerKey>& without = {});

/// Locates the base at each instant of a recording: all poses that explain the mapped markers. Odometry from
/// the nearest unambiguous instants resolves ambiguities and replaces missing observations.
/// @param kept hypotheses of each instant; one with hypotheses is not located from scratch, but again if they
/// are ambiguous and odometry predicts it
std::vector<InstantHypotheses> locateRecording(const MarkerRecording& recording, const MarkerMap& map,
                                               const PathParams& params,
                                               std::vector<InstantHypotheses> kept = {});

/// Whether the best hypothesis has at least this probability.
bool isUnambiguous(const InstantHypotheses& hypotheses, double min_probability);

/// Whether the best hypothesis can be used as the pose: it is unambiguous, or several markers agree on it.
bool isUsable(const InstantHypotheses& hypotheses, double min_probability);

}  // namespace sextant
