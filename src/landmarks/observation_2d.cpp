// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/observation_2d.hpp"

namespace sextant {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Landmark2D toRobotFrame(const Pose2& T_map_base, const Landmark2D& landmark) {
  Landmark2D seen{T_map_base.inverse() * landmark.position, {}};
  if (landmark.heading) seen.heading = wrapped(*landmark.heading - T_map_base.heading);
  return seen;
}

int commonDimension(const Observation2D& observation, const Landmark2D& landmark) {
  return observation.heading && landmark.heading ? 3 : 2;
}

VectorXd innovations(const std::vector<AssociatedObservation>& observations,
                     const std::vector<Landmark2D>& predicted) {
  VectorXd all(3 * observations.size());
  Index at = 0;
  for (size_t i = 0; i < observations.size(); ++i) {
    const Observation2D& observation = observations[i].observation;
    all.segment<2>(at) = observation.position - predicted[i].position;
    at += 2;
    if (commonDimension(observation, predicted[i]) == 3)
      all(at++) = wrapped(*observation.heading - *predicted[i].heading);
  }
  return all.head(at);
}

MatrixXd observationNoise(const std::vector<AssociatedObservation>& observations,
                          const std::vector<Landmark2D>& landmarks) {
  MatrixXd R = MatrixXd::Zero(3 * observations.size(), 3 * observations.size());
  Index at = 0;
  for (const AssociatedObservation& each : observations) {
    const int dimension = commonDimension(each.observation, landmarks[each.landmark]);
    R.block(at, at, dimension, dimension) = each.observation.covariance.topLeftCorner(dimension, dimension);
    at += dimension;
  }
  return R.topLeftCorner(at, at);
}

}  // namespace sextant
