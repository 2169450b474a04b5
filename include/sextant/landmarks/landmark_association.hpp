// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// Parameters of the data association of observations with landmarks.
struct AssociationParams {
  double gate = 0.999;
  double new_landmark_gate = 0.999999;
  double ambiguity_margin = 6.0;
  double new_landmark_density = 0.01;
  double new_landmark_margin = 4.0;
  int max_hypotheses = 20000;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// Result of the association of one observation: with a landmark, with none, or not to be used.
enum class Outcome { associated, unassociated, ambiguous };

/// Association of one observation.
struct Association {
  Outcome outcome = Outcome::unassociated;  ///< whether it belongs to a landmark
  size_t landmark = 0;                      ///< index if associated, or if an id is ambiguous
};

/// One way to explain all observations of a scan.
struct JointAssociation {
  std::vector<Association> outcomes;  ///< one per observation
  double log_likelihood = 0;          ///< natural logarithm of their density, 1/m^2 each
};

/// A landmark that may be in view; only observations with the same label are associated with it.
struct LandmarkPoint {
  Eigen::Vector2d position;  ///< in the robot frame
  LandmarkLabel label;       ///< class and id
};

/// Joint compatibility branch and bound (Neira and Tardos 2001): the largest set of pairings that is jointly
/// compatible, and among those the one with the least Mahalanobis distance. Each landmark is paired with at
/// most one observation. The search stops after max_hypotheses with the best set found.
/// @param covariance (2n, 2n) of the predicted positions of the n landmarks, without sensor noise
/// @returns one association per observation
std::vector<Association> associate(const std::vector<LandmarkPoint>& landmarks,
                                   const Eigen::MatrixXd& covariance,
                                   const std::vector<PositionObservation>& observations,
                                   const AssociationParams& params);

/// As associate(), but an ambiguous observation is not left unused: the most likely ways to explain all of
/// them, each with one of the landmarks that are compatible or with none: those stay ambiguous.
/// @param log_density_of_none logarithm of the density of each observation if it is of no landmark in the map
/// @param most maximum number of results; 1: as associate()
/// @returns at least one, the most likely first
std::vector<JointAssociation> associations(const std::vector<LandmarkPoint>& landmarks,
                                           const Eigen::MatrixXd& covariance,
                                           const std::vector<PositionObservation>& observations,
                                           const std::vector<double>& log_density_of_none,
                                           const AssociationParams& params, size_t most);

}  // namespace sextant
