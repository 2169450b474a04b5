// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sextant/landmarks/explored_area.hpp"
#include "sextant/landmarks/landmark_association.hpp"
#include "sextant/landmarks/landmark_candidates.hpp"
#include "sextant/landmarks/landmark_register.hpp"
#include "sextant/landmarks/landmark_sensor.hpp"

namespace sextant {

/// One way to explain a scan.
struct ScanInterpretation {
  std::vector<Association> outcomes;  ///< of each observation; landmarks by their index
  std::vector<size_t> in_view;        ///< landmarks without an id that are expected in view
  bool slipped = false;               ///< whether odometry slipped before it
  double log_likelihood = 0;          ///< natural logarithm of the density of the observations
};

/// What is known besides the map.
struct MapKnowledge {
  const LandmarkSensor& sensor;          ///< of the observations
  const AssociationParams& association;  ///< its parameters
  const LandmarkCandidates& candidates;  ///< that may become landmarks
  const LandmarkCandidates& unused;      ///< of ambiguous observations
  const ExploredArea& explored;          ///< where unknown landmarks are improbable
  double unconfirmed;                    ///< metres and radians driven since a landmark was associated
  Detects detects = Detects::all;        ///< what the sensor of the scan detects
};

/// The most likely ways to explain a scan, the best first; at least one.
/// @param map is not changed @param observations in the robot frame @param most maximum number; 1: ambiguous
/// observations are not used
std::vector<ScanInterpretation> interpretScan(LandmarkRegister& map, const MapKnowledge& knowledge,
                                              const std::vector<LabelledObservation>& observations,
                                              const Pose2& T_base_sensor, size_t most);

/// Covariance (3, 3) of a slip of odometry in the robot frame, square metres and radians.
Eigen::Matrix3d slipCovariance();

}  // namespace sextant
