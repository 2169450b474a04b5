// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/reprojection.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;
using Matrix86d = Eigen::Matrix<double, 8, 6>;

constexpr double kUnreachable = 1e6;  // squared Mahalanobis distance of a marker out of the lens's reach
constexpr double kUnreachablePixels = 1000.0;
constexpr int kMaxIterations = 60;
constexpr double kMinDecrease = 1e-14;  // of the cost, that a step promises
constexpr double kMinInformationRatio = 1e-12;

double square(double x) { return x * x; }

// Of all eight coordinates of a marker in the mean square of residuals: a hidden corner counts little.
double coordinateWeight(const MarkerSighting& sighting) {
  double sum = 0;
  for (const double sigma : sighting.sigmas) sum += 2 / square(sigma);
  return sum;
}

// A marker's residuals with their derivatives, whitened: the noise of each coordinate is 1.
struct Block {
  Vector8d residual;
  Matrix86d jacobian;
  double squares;  // of the plain residuals over their corner's deviation
};

// With v = p_map - p: p_base = R' v, d p_base = -R' dp + R' [v]x dr. The marker's own pose moves p_map the
// other way round.
std::optional<Block> linearize(const MarkerSighting& sighting, const Pose& T_map_base) {
  const Eigen::Matrix3d R_camera_map = sighting.T_camera_base.linear() * T_map_base.linear().transpose();
  const auto points = markerCorners(sighting.size);
  const bool exact = sighting.map_covariance.isZero(0.0);
  Block block;
  Matrix86d by_marker;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d arm = sighting.T_map_marker.linear() * points[k];
    const Eigen::Vector3d v = arm + sighting.T_map_marker.translation() - T_map_base.translation();
    const auto projection =
        sighting.camera->projectWithJacobian(R_camera_map * v + sighting.T_camera_base.translation());
    if (!projection) return std::nullopt;
    const Eigen::Matrix<double, 2, 3> by_point = projection->jacobian * R_camera_map;
    block.residual.segment<2>(2 * k) = projection->pixel - sighting.corners[k];
    block.jacobian.block<2, 6>(2 * k, 0) << -by_point, by_point * skew(v);
    if (!exact) by_marker.block<2, 6>(2 * k, 0) << by_point, -by_point * skew(arm);
  }
  block.squares = 0;
  for (int k = 0; k < 4; ++k)
    block.squares += block.residual.segment<2>(2 * k).squaredNorm() / square(sighting.sigmas[k]);
  if (exact) {
    for (int k = 0; k < 4; ++k) {
      block.residual.segment<2>(2 * k) /= sighting.sigmas[k];
      block.jacobian.middleRows<2>(2 * k) /= sighting.sigmas[k];
    }
    return block;
  }
  Matrix8d S = by_marker * sighting.map_covariance * by_marker.transpose();
  for (int i = 0; i < 8; ++i) S(i, i) += sighting.sigmas[i / 2] * sighting.sigmas[i / 2];
  const Eigen::LLT<Matrix8d> cholesky(S);
  cholesky.matrixL().solveInPlace(block.residual);
  cholesky.matrixL().solveInPlace(block.jacobian);
  return block;
}

struct FloorBlock {
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 6> jacobian = Eigen::Matrix<double, 3, 6>::Zero();
};

// Height, and where the base's upward axis u leans: du = dr x u.
FloorBlock linearize(const FloorPrior& floor, const Pose& T_map_base) {
  const Eigen::Vector3d up = T_map_base.linear().col(2);
  FloorBlock block;
  block.residual << T_map_base.translation().z() / floor.height_sigma, up.head<2>() / floor.tilt_sigma;
  block.jacobian(0, 2) = 1 / floor.height_sigma;
  block.jacobian.block<2, 3>(1, 3) = -skew(up).topRows<2>() / floor.tilt_sigma;
  return block;
}

struct Loss {
  double rho;
  double weight;  // d rho / d s
};

// rho(s) = s for s <= w^2, else 2 w sqrt(s) - w^2.
Loss huber(double s, double width) {
  if (s <= width * width) return {s, 1.0};
  const double root = std::sqrt(s);
  return {2 * width * root - width * width, width / root};
}

void add(const MarkerSighting& sighting, const Pose& T_map_base, double robust_width,
         ReprojectionModel& sum) {
  const auto block = linearize(sighting, T_map_base);
  const Loss loss = huber(block ? block->residual.squaredNorm() : kUnreachable, robust_width);
  sum.cost += loss.rho;
  sum.squares += block ? block->squares : square(kUnreachablePixels) * coordinateWeight(sighting);
  if (!block) return;
  const Matrix6d JtJ = block->jacobian.transpose() * block->jacobian;
  sum.H += loss.weight * JtJ;
  sum.information += JtJ;
  sum.g.noalias() += loss.weight * block->jacobian.transpose() * block->residual;
}

bool determined(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information, Eigen::EigenvaluesOnly);
  const auto& values = solver.eigenvalues();
  return values.allFinite() && values[0] > kMinInformationRatio * values[5] && values[5] > 0;
}

}  // namespace

Pivot::Pivot(const std::vector<MarkerSighting>& sightings) {
  for (const MarkerSighting& sighting : sightings) centre_ += sighting.T_map_marker.translation();
  if (!sightings.empty()) centre_ /= static_cast<double>(sightings.size());
}

Pose Pivot::moved(const Pose& T_map_base, const Vector6d& step) const {
  const Eigen::Matrix3d turn = expSO3(step.tail<3>());
  Pose moved = T_map_base;
  moved.translation() = centre_ + turn * (T_map_base.translation() - centre_ + step.head<3>());
  moved.linear() = turn * T_map_base.linear();
  return moved;
}

Matrix6d Pivot::jacobian(const Pose& T_map_base) const {
  Matrix6d M = Matrix6d::Identity();
  M.topRightCorner<3, 3>() = -skew(T_map_base.translation() - centre_);
  return M;
}

double squaredMahalanobis(const MarkerSighting& sighting, const Pose& T_map_base) {
  const auto block = linearize(sighting, T_map_base);
  return block ? block->residual.squaredNorm() : std::numeric_limits<double>::infinity();
}

double squaredMahalanobis(const FloorPrior& floor, const Pose& T_map_base) {
  return linearize(floor, T_map_base).residual.squaredNorm();
}

ReprojectionModel reprojectionModel(const std::vector<MarkerSighting>& sightings, const Pose& T_map_base,
                                    const ReprojectionParams& params) {
  ReprojectionModel sum;
  for (const MarkerSighting& sighting : sightings) add(sighting, T_map_base, params.robust_width, sum);
  if (!params.floor) return sum;
  const FloorBlock block = linearize(*params.floor, T_map_base);
  const Matrix6d JtJ = block.jacobian.transpose() * block.jacobian;
  sum.H += JtJ;
  sum.information += JtJ;
  sum.g += block.jacobian.transpose() * block.residual;
  sum.cost += block.residual.squaredNorm();
  return sum;
}

std::optional<ReprojectionFit> minimizeReprojection(const std::vector<MarkerSighting>& sightings,
                                                    const Pose& start, const ReprojectionParams& params) {
  const Pivot pivot(sightings);
  Pose pose = start;
  ReprojectionModel now = reprojectionModel(sightings, pose, params);
  double lambda = 1e-4;
  for (int i = 0; i < kMaxIterations && lambda < 1e12; ++i) {
    const Matrix6d M = pivot.jacobian(pose);
    Matrix6d damped = M.transpose() * now.H * M;
    damped.diagonal() *= 1 + lambda;
    const Vector6d gradient = M.transpose() * now.g, step = damped.ldlt().solve(-gradient);
    if (!step.allFinite()) return std::nullopt;
    const Pose trial = pivot.moved(pose, step);
    const ReprojectionModel next = reprojectionModel(sightings, trial, params);
    const bool better = next.cost <= now.cost;
    lambda = better ? std::max(0.1 * lambda, 1e-12) : 10 * lambda;
    if (better) {
      pose = trial;
      now = next;
    }
    if (-gradient.dot(step) < kMinDecrease) break;
  }
  if (!isFinite(pose) || !determined(now.information)) return std::nullopt;
  pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  double weight = 0;
  for (const MarkerSighting& sighting : sightings) weight += coordinateWeight(sighting);
  return ReprojectionFit{pose, now.cost, std::sqrt(now.squares / weight), now.information};
}

}  // namespace sextant
