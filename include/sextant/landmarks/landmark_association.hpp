// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// Parameters of the data association of sightings with landmarks.
struct AssociationParams {
  double gate = 0.999;
  double doubt = 0.999999;
  double margin = 6.0;
  double density = 0.01;
  double new_margin = 4.0;
  int effort = 20000;

  ParamList fields();
};

/// What a sighting is of.
enum class Origin { known, unknown, doubtful };

struct Association {
  Origin origin = Origin::unknown;
  size_t landmark = 0;  ///< where it is known: index among the candidates
};

/// A landmark that may be seen; only sightings of its class are ever associated with it.
struct LandmarkPoint {
  Eigen::Vector2d position;  ///< in the robot frame
  LandmarkLabel label;
};

/// One answer for every sighting; a landmark is known to one of them at most.
/// Branch and bound for the largest set that is jointly compatible, the nearest of those (Neira and
/// Tardos 2001).
/// @param covariance (2n, 2n) of where the n landmarks should be seen, without a sensor's noise
std::vector<Association> associate(const std::vector<LandmarkPoint>& landmarks,
                                   const Eigen::MatrixXd& covariance,
                                   const std::vector<LandmarkPointSighting>& sightings,
                                   const AssociationParams& params);

}  // namespace sextant
