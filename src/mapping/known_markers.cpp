// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "known_markers.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr double kWrong = 18.0;  // chi-square with 3 degrees of freedom, exceeded by one of 2000
// Factor on the covariance from the recording: over a chain of markers, errors grow more than corner noise
// predicts.
constexpr double kDistrust = 4.0;
constexpr double kMedian = 2.366;       // median of the same distribution
constexpr size_t kEnoughKnown = 8;      // minimum number of markers to estimate a scale
constexpr double kMinReduction = 1e-6;  // minimum reduction of a prior's variance by the recording, relative
constexpr double kMaxScale = 1e5;
constexpr double kLoosePosition = 0.02;  // metres
constexpr double kLooseAngle = 0.03;     // radians
constexpr double kExact = 1e-6;          // metres or radians; standard deviation of a marker given as exact
// Position or rotation of a known marker from the recording alone.
struct Deviation {
  Eigen::Vector3d offset;      // from the known value
  Eigen::Matrix3d covariance;  // of the recording
  Eigen::Matrix3d known;       // covariance of the known value
  // Squared Mahalanobis distance with scaled covariances.
  double squared(double scale, double distrust = 1.0) const {
    const Eigen::Matrix3d both = distrust * covariance + scale * scale * known;
    return offset.dot(both.ldlt().solve(offset));
  }
};

// Removes the prior from the minimum: from the error e and the covariance P = (S^-1 + R^-1)^-1 there, with
// the prior's covariance S, computes R and the offset of the recording alone.
Deviation withoutPrior(const Eigen::Vector3d& e, const Eigen::Matrix3d& P, const Eigen::Matrix3d& S,
                       const Eigen::Matrix3d& known) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> solver(P, S);
  const Eigen::Matrix3d &V = solver.eigenvectors(), axes = S * V;  // V' S V = 1
  Eigen::Vector3d offset = V.transpose() * e, variances;
  for (int i = 0; i < 3; ++i) {
    const double share = std::clamp(solver.eigenvalues()[i], 0.0, 1.0),
                 rest = std::max(1 - share, kMinReduction);
    offset[i] /= -rest;
    variances[i] = share / rest;
  }
  return {axes * offset, axes * variances.asDiagonal() * axes.transpose(), known};
}

Eigen::Matrix3d positive(const Eigen::Matrix3d& covariance) {
  return covariance + kExact * kExact * Eigen::Matrix3d::Identity();
}

struct MarkerDeviation {
  MarkerKey key;
  Deviation position, rotation;
};

// Of every observed known marker that is not exact.
std::vector<MarkerDeviation> deviations(const MarkerMap& known, const MarkerMap& held, const MarkerMap& map,
                                        const Eigen::MatrixXd& covariance) {
  std::vector<MarkerDeviation> all;
  Eigen::Index row = -6;
  for (const auto& [key, found] : map.markers()) {
    row += 6;
    const MappedMarker *before = known.find(key), *prior = held.find(key);
    const Matrix6d P = covariance.block<6, 6>(row, row);
    if (!before || !prior || before->covariance.isZero(0.0) || P.isZero(0.0)) continue;
    const Vector6d e = poseError(before->T_map_marker, found.T_map_marker);
    const auto part = [&](int i) {
      return withoutPrior(e.segment<3>(i), P.block<3, 3>(i, i), positive(prior->covariance.block<3, 3>(i, i)),
                          positive(before->covariance.block<3, 3>(i, i)));
    };
    all.push_back({key, part(0), part(3)});
  }
  return all;
}

double medianSquare(const std::vector<Deviation>& all, double scale) {
  std::vector<double> squares;
  for (const Deviation& each : all) squares.push_back(each.squared(scale));
  const auto middle = squares.begin() + static_cast<long>((squares.size() - 1) / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return *middle;
}

// By bisection, because the median decreases with the scale.
double scaleOf(const std::vector<Deviation>& all) {
  if (all.size() < kEnoughKnown || medianSquare(all, 1) <= kMedian) return 1.0;
  double low = 1, high = kMaxScale;
  while (high / low > 1.001) {
    const double middle = std::sqrt(low * high);
    (medianSquare(all, middle) > kMedian ? low : high) = middle;
  }
  return high;
}

}  // namespace

std::vector<KnownMarkerCheck> checkKnown(const MarkerMap& held, const MarkerMap& map,
                                         const Eigen::MatrixXd& covariance) {
  std::vector<KnownMarkerCheck> checks;
  for (const MarkerDeviation& each : deviations(held, held, map, covariance)) {
    KnownMarkerCheck check{each.key,
                           {},
                           std::max(each.position.squared(1, kDistrust), each.rotation.squared(1, kDistrust)),
                           false};
    check.offset << each.position.offset, each.rotation.offset;
    check.wrong = check.squared_distance > kWrong;
    checks.push_back(check);
  }
  return checks;
}

KnownScales knownScales(const MarkerMap& known, const MarkerMap& held, const MarkerMap& map,
                        const Eigen::MatrixXd& covariance) {
  std::vector<Deviation> positions, rotations;
  for (const MarkerDeviation& each : deviations(known, held, map, covariance)) {
    positions.push_back(each.position);
    rotations.push_back(each.rotation);
  }
  return {scaleOf(positions), scaleOf(rotations)};
}

MarkerMap scaledKnown(const MarkerMap& known, const KnownScales& scales) {
  Vector6d factors;
  factors << Eigen::Vector3d::Constant(scales.position), Eigen::Vector3d::Constant(scales.rotation);
  MarkerMap scaled(known.frame());
  for (auto [key, marker] : known.markers()) {
    marker.covariance = factors.asDiagonal() * marker.covariance * factors.asDiagonal();
    scaled.add(marker);
  }
  return scaled;
}

MarkerMap loosenedKnown(const MarkerMap& known) {
  if (known.markers().size() < 2) return known;
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(kLoosePosition), Eigen::Vector3d::Constant(kLooseAngle);
  MarkerMap loose(known.frame());
  for (auto [key, marker] : known.markers()) {
    marker.covariance.diagonal() += sigmas.cwiseAbs2();
    loose.add(marker);
  }
  return loose;
}

MarkerMap withoutMarker(const MarkerMap& map, const MarkerKey& key) {
  MarkerMap rest(map.frame());
  for (const auto& entry : map.markers())
    if (!(entry.first == key)) rest.add(entry.second);
  return rest;
}

}  // namespace sextant
