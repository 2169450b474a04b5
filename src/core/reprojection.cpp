// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/reprojection.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace sextant {
namespace {

constexpr double kUnreachable = 1000.0;  // pixels that a point out of the lens's reach is said to be off
constexpr int kMaxIterations = 60;
constexpr double kMinStep = 1e-10;  // metres and radians
constexpr double kMinInformationRatio = 1e-12;

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double cost = 0.0;
  double squares = 0.0;  // of the plain residuals, pixels^2
};

struct Loss {
  double rho;
  double weight;  // d rho / d s
};

Loss huber(double s, double width) {
  if (s <= width * width) return {s, 1.0};
  const double root = std::sqrt(s);
  return {2 * width * root - width * width, width / root};
}

// With v = p_map - p: p_base = R' v, d p_base = -R' dp + R' [v]x dr.
void add(const Sighting& sighting, const Pose& T_map_base, const ReprojectionParams& params,
         NormalEquations& sum) {
  const Eigen::Vector3d v = sighting.p_map - T_map_base.translation();
  const Eigen::Matrix3d R_camera_map = sighting.T_camera_base.linear() * T_map_base.linear().transpose();
  const auto projection =
      sighting.camera->projectWithJacobian(R_camera_map * v + sighting.T_camera_base.translation());
  if (!projection) {
    sum.cost += huber(std::pow(kUnreachable / params.sigma, 2), params.robust_width).rho;
    sum.squares += kUnreachable * kUnreachable;
    return;
  }
  const Eigen::Vector2d residual = projection->pixel - sighting.pixel;
  Eigen::Matrix<double, 2, 6> J;
  J.leftCols<3>() = -projection->jacobian * R_camera_map;
  J.rightCols<3>() = projection->jacobian * R_camera_map * skew(v);
  const double scale = 1.0 / (params.sigma * params.sigma);
  const Loss loss = huber(residual.squaredNorm() * scale, params.robust_width);
  sum.H.noalias() += (loss.weight * scale) * J.transpose() * J;
  sum.g.noalias() += (loss.weight * scale) * J.transpose() * residual;
  sum.cost += loss.rho;
  sum.squares += residual.squaredNorm();
}

NormalEquations linearize(const std::vector<Sighting>& sightings, const Pose& T_map_base,
                          const ReprojectionParams& params) {
  NormalEquations sum;
  for (const Sighting& sighting : sightings) add(sighting, T_map_base, params, sum);
  return sum;
}

bool determined(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(information, Eigen::EigenvaluesOnly);
  const auto& values = solver.eigenvalues();
  return values.allFinite() && values[0] > kMinInformationRatio * values[5] && values[5] > 0;
}

}  // namespace

double reprojectionCost(const std::vector<Sighting>& sightings, const Pose& T_map_base,
                        const ReprojectionParams& params) {
  return linearize(sightings, T_map_base, params).cost;
}

std::optional<ReprojectionFit> minimizeReprojection(const std::vector<Sighting>& sightings, const Pose& start,
                                                    const ReprojectionParams& params) {
  Pose pose = start;
  NormalEquations now = linearize(sightings, pose, params);
  double lambda = 1e-4;
  for (int i = 0; i < kMaxIterations && lambda < 1e12; ++i) {
    Matrix6d damped = now.H;
    damped.diagonal() *= 1 + lambda;
    const Vector6d step = damped.ldlt().solve(-now.g);
    if (!step.allFinite()) return std::nullopt;
    const Pose trial = perturbed(pose, step);
    const NormalEquations next = linearize(sightings, trial, params);
    const bool better = next.cost <= now.cost;
    lambda = better ? std::max(0.1 * lambda, 1e-12) : 10 * lambda;
    if (better) {
      pose = trial;
      now = next;
    }
    if (step.norm() < kMinStep) break;
  }
  if (!isFinite(pose) || !determined(now.H)) return std::nullopt;
  pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  return ReprojectionFit{pose, now.cost, std::sqrt(now.squares / (2.0 * sightings.size())), now.H};
}

}  // namespace sextant
