// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// How sightings are told to be of known landmarks.
struct AssociationParams {
  double gate = 0.999;      ///< probability within which a sighting is compatible with its landmark, [0.5, 1)
  double doubt = 0.999999;  ///< and beyond which it is of another one; between the two: in doubt, [gate, 1)
  double margin = 6.0;      ///< squared Mahalanobis distance by which the next best has to be worse, [0, 100]
  double density =
      0.01;  ///< of landmarks of a class that are not known yet, where one looks, 1/m^2, (0, 1000]
  double new_margin = 4.0;  ///< as margin, against being one of those, [0, 100]
  int effort = 20000;       ///< pairs that the joint search looks at, at most, [100, 1e9]

  /// @throws std::invalid_argument that names the first field out of range.
  void validate() const;
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
