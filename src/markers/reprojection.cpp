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

constexpr double kUnreachable = 1e6;  // squared Mahalanobis distance of a marker that does not project
constexpr double kUnreachablePixels = 1000.0;  // residual of each coordinate of such a marker
constexpr int kMaxIterations = 60;
constexpr double kMinDecrease =
    1e-10;  // of the cost, as predicted for a step; a smaller one ends the minimization
constexpr double kMinInformationRatio = 1e-12;  // smallest over largest eigenvalue of a determined pose

double square(double x) { return x * x; }

// Weight of a marker's eight coordinates in the mean square residual; small for occluded corners.
double coordinateWeight(const MarkerObservation& observation) {
  double sum = 0;
  for (const double sigma : observation.sigmas) sum += 2 / square(sigma);
  return sum;
}

// Whitened residuals of a marker and their Jacobian with respect to the base pose.
struct Block {
  Vector8d residual;
  Matrix86d jacobian;
  double squares;  // sum of squared residuals over the variance of the corner noise alone
};

// A corner p_map, seen from the base at p with rotation R: with v = p_map - p, p_base = R' v and
// d p_base = -R' dp + R' [v]x dr. The Jacobian with respect to the marker's pose has the opposite sign, and
// the arm from the marker's centre instead of v. Calls use(k, residual, by_point, v, arm) for each corner k.
template <typename Use>
bool forEachCorner(const MarkerObservation& observation, const Pose& T_map_base, Use&& use) {
  const Eigen::Matrix3d R_camera_map = observation.T_camera_base.linear() * T_map_base.linear().transpose();
  const auto points = markerCorners(observation.size);
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d arm = observation.T_map_marker.linear() * points[k];
    const Eigen::Vector3d v = arm + observation.T_map_marker.translation() - T_map_base.translation();
    const auto projection =
        observation.camera->projectWithJacobian(R_camera_map * v + observation.T_camera_base.translation());
    if (!projection) return false;
    use(k, Eigen::Vector2d(projection->pixel - observation.corners[k]),
        Eigen::Matrix<double, 2, 3>(projection->jacobian * R_camera_map), v, arm);
  }
  return true;
}

Matrix8d covarianceOf(const MarkerObservation& observation, const Matrix86d& by_marker) {
  Matrix8d S = by_marker * observation.map_covariance * by_marker.transpose();
  for (int i = 0; i < 8; ++i) S(i, i) += square(observation.sigmas[i / 2]);
  return S;
}

std::optional<Block> linearize(const MarkerObservation& observation, const Pose& T_map_base) {
  const bool exact = observation.map_covariance.isZero(0.0);
  Block block;
  block.squares = 0;
  Matrix86d by_marker;
  const auto use = [&](int k, const Eigen::Vector2d& residual, const Eigen::Matrix<double, 2, 3>& by_point,
                       const Eigen::Vector3d& v, const Eigen::Vector3d& arm) {
    block.residual.segment<2>(2 * k) = residual;
    block.jacobian.block<2, 6>(2 * k, 0) << -by_point, by_point * skew(v);
    if (!exact) by_marker.block<2, 6>(2 * k, 0) << by_point, -by_point * skew(arm);
    block.squares += residual.squaredNorm() / square(observation.sigmas[k]);
  };
  if (!forEachCorner(observation, T_map_base, use)) return std::nullopt;
  if (exact) {
    for (int k = 0; k < 4; ++k) {
      block.residual.segment<2>(2 * k) /= observation.sigmas[k];
      block.jacobian.middleRows<2>(2 * k) /= observation.sigmas[k];
    }
    return block;
  }
  const Eigen::LLT<Matrix8d> cholesky(covarianceOf(observation, by_marker));
  cholesky.matrixL().solveInPlace(block.residual);
  cholesky.matrixL().solveInPlace(block.jacobian);
  return block;
}

struct FloorBlock {
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 6> jacobian = Eigen::Matrix<double, 3, 6>::Zero();
};

// Residuals: height, and the horizontal part of the base's upward axis u, for which du = dr x u.
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

// Loss of a squared norm s: rho(s) = s for s <= w^2, else 2 w sqrt(s) - w^2.
Loss huber(double s, double width) {
  if (s <= width * width) return {s, 1.0};
  const double root = std::sqrt(s);
  return {2 * width * root - width * width, width / root};
}

void add(const MarkerObservation& observation, const Pose& T_map_base, double robust_width,
         ReprojectionModel& sum) {
  const auto block = linearize(observation, T_map_base);
  const Loss loss = huber(block ? block->residual.squaredNorm() : kUnreachable, robust_width);
  sum.cost += loss.rho;
  sum.squares += block ? block->squares : square(kUnreachablePixels) * coordinateWeight(observation);
  if (!block) return;
  const Matrix6d JtJ = block->jacobian.transpose().lazyProduct(block->jacobian);  // faster for this size
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

Pivot::Pivot(const std::vector<MarkerObservation>& observations) {
  for (const MarkerObservation& observation : observations) centre_ += observation.T_map_marker.translation();
  if (!observations.empty()) centre_ /= static_cast<double>(observations.size());
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

double squaredMahalanobis(const MarkerObservation& observation, const Pose& T_map_base) {
  const auto block = linearize(observation, T_map_base);
  return block ? block->residual.squaredNorm() : std::numeric_limits<double>::infinity();
}

double squaredMahalanobis(const FloorPrior& floor, const Pose& T_map_base) {
  return linearize(floor, T_map_base).residual.squaredNorm();
}

std::optional<MarkerLinearization> linearizedMarker(const MarkerObservation& observation,
                                                    const Pose& T_map_base) {
  MarkerLinearization all;
  const auto use = [&](int k, const Eigen::Vector2d& residual, const Eigen::Matrix<double, 2, 3>& by_point,
                       const Eigen::Vector3d& v, const Eigen::Vector3d& arm) {
    all.residual.segment<2>(2 * k) = residual;
    all.by_base.block<2, 6>(2 * k, 0) << -by_point, by_point * skew(v);
    all.by_marker.block<2, 6>(2 * k, 0) << by_point, -by_point * skew(arm);
    all.by_size.segment<2>(2 * k) = by_point * arm;
  };
  if (!forEachCorner(observation, T_map_base, use)) return std::nullopt;
  all.covariance = covarianceOf(observation, all.by_marker);
  return all;
}

ReprojectionModel reprojectionModel(const std::vector<MarkerObservation>& observations,
                                    const Pose& T_map_base, const ReprojectionParams& params) {
  ReprojectionModel sum;
  for (const MarkerObservation& observation : observations)
    add(observation, T_map_base, params.robust_width, sum);
  if (!params.floor) return sum;
  const FloorBlock block = linearize(*params.floor, T_map_base);
  const Matrix6d JtJ = block.jacobian.transpose() * block.jacobian;
  sum.H += JtJ;
  sum.information += JtJ;
  sum.g += block.jacobian.transpose() * block.residual;
  sum.cost += block.residual.squaredNorm();
  return sum;
}

std::optional<ReprojectionFit> minimizeReprojection(const std::vector<MarkerObservation>& observations,
                                                    const Pose& start, const ReprojectionParams& params) {
  const Pivot pivot(observations);
  Pose pose = start;
  ReprojectionModel now = reprojectionModel(observations, pose, params);
  double lambda = 1e-4;
  for (int i = 0; i < kMaxIterations && lambda < 1e12; ++i) {
    const Matrix6d M = pivot.jacobian(pose);
    Matrix6d damped = M.transpose() * now.H * M;
    damped.diagonal() *= 1 + lambda;
    const Vector6d gradient = M.transpose() * now.g, step = damped.ldlt().solve(-gradient);
    if (!step.allFinite()) return std::nullopt;
    const Pose trial = pivot.moved(pose, step);
    const ReprojectionModel next = reprojectionModel(observations, trial, params);
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
  for (const MarkerObservation& observation : observations) weight += coordinateWeight(observation);
  return ReprojectionFit{pose, now.cost, std::sqrt(now.squares / weight), now.information};
}

}  // namespace sextant
