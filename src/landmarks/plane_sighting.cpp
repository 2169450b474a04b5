// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/plane_sighting.hpp"

namespace sextant {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

PlaneLandmark seenFrom(const Pose2& T_map_base, const PlaneLandmark& landmark) {
  PlaneLandmark seen{T_map_base.inverse() * landmark.position, {}};
  if (landmark.heading) seen.heading = wrapped(*landmark.heading - T_map_base.heading);
  return seen;
}

int commonWidth(const PlaneSighting& sighting, const PlaneLandmark& landmark) {
  return sighting.heading && landmark.heading ? 3 : 2;
}

VectorXd differences(const std::vector<KnownSighting>& seen, const std::vector<PlaneLandmark>& expected) {
  VectorXd all(3 * seen.size());
  Index at = 0;
  for (size_t i = 0; i < seen.size(); ++i) {
    const PlaneSighting& sighting = seen[i].sighting;
    all.segment<2>(at) = sighting.position - expected[i].position;
    at += 2;
    if (commonWidth(sighting, expected[i]) == 3)
      all(at++) = wrapped(*sighting.heading - *expected[i].heading);
  }
  return all.head(at);
}

MatrixXd noiseOf(const std::vector<KnownSighting>& seen, const std::vector<PlaneLandmark>& landmarks) {
  MatrixXd R = MatrixXd::Zero(3 * seen.size(), 3 * seen.size());
  Index at = 0;
  for (const KnownSighting& each : seen) {
    const int width = commonWidth(each.sighting, landmarks[each.landmark]);
    R.block(at, at, width, width) = each.sighting.covariance.topLeftCorner(width, width);
    at += width;
  }
  return R.topLeftCorner(at, at);
}

}  // namespace sextant
