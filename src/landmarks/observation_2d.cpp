// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/observation_2d.hpp"

#include <cmath>

namespace sextant {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kGross = 0.05, kGrossScale = 16;  // share of gross errors, and factor of their variances

}  // namespace

double logDensity(double distance, double root_determinant) {
  return std::log((1 - kGross) * std::exp(-0.5 * distance) +
                  kGross / kGrossScale * std::exp(-0.5 * distance / kGrossScale)) -
         std::log(2 * M_PI * root_determinant);
}

Landmark2D toRobotFrame(const Pose2& T_map_base, const Landmark2D& landmark) {
  Landmark2D seen{T_map_base.inverse() * landmark.position, {}};
  if (landmark.heading) seen.heading = wrapped(*landmark.heading - T_map_base.heading);
  return seen;
}

PositionObservation inMap(const Pose2& T_map_base, const LabelledObservation& seen) {
  const Observation2D moved = T_map_base * seen.observation;
  return {moved.position, moved.covariance.topLeftCorner<2, 2>(), seen.label};
}

Observation2D operator*(const Pose2& T_a_b, const Observation2D& observation) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = rotation2(T_a_b.heading);
  Observation2D moved{T_a_b * observation.position, {}, R * observation.covariance * R.transpose()};
  if (observation.heading) moved.heading = wrapped(*observation.heading + T_a_b.heading);
  return moved;
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
