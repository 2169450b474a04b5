// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_smoother.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

constexpr int kMaxIterations = 200;

using Block = std::array<double, 3>;  // x, y, heading

template <typename T>
T wrappedAngle(const T& angle) {
  return atan2(sin(angle), cos(angle));
}

/// b in the frame of a pose a: x, y, heading.
template <typename T>
Eigen::Matrix<T, 3, 1> relative(const T* a, const T* b) {
  const T c = cos(a[2]), s = sin(a[2]), x = b[0] - a[0], y = b[1] - a[1];
  return {c * x + s * y, c * y - s * x, b[2] - a[2]};
}

/// L^-1 of a covariance L L^T.
MatrixXd whitening(const MatrixXd& covariance) {
  const Eigen::LLT<MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success)
    throw std::invalid_argument("the covariance of a step or a sighting is not positive definite");
  return factor.matrixL().solve(MatrixXd::Identity(covariance.rows(), covariance.cols()));
}

/// What a step was off by, where it begins: X' = X exp(w) U.
struct StepCost {
  Pose2 step;
  Matrix3d whitened;

  template <typename T>
  bool operator()(const T* before, const T* after, T* residuals) const {
    const Eigen::Matrix<T, 3, 1> moved = relative(before, after);
    const T turned = wrappedAngle(T(moved(2) - step.heading)), c = cos(turned), s = sin(turned);
    const Eigen::Vector2d& U = step.position;
    const Eigen::Matrix<T, 3, 1> off(moved(0) - (c * U.x() - s * U.y()), moved(1) - (s * U.x() + c * U.y()),
                                     turned);
    Eigen::Map<Eigen::Matrix<T, 3, 1>>(residuals, 3) = whitened.cast<T>() * off;
    return true;
  }
};

/// Width rows: x, y[, heading].
template <int Width>
struct SightingCost {
  Eigen::Vector3d measured;
  Eigen::Matrix<double, Width, Width> whitened;

  template <typename T>
  bool operator()(const T* pose, const T* landmark, T* residuals) const {
    Eigen::Matrix<T, 3, 1> off = relative(pose, landmark) - measured.cast<T>();
    off(2) = wrappedAngle(T(off(2)));
    Eigen::Map<Eigen::Matrix<T, Width, 1>>(residuals, Width) =
        whitened.template cast<T>() * off.template head<Width>();
    return true;
  }
};

template <int Width>
ceres::CostFunction* sightingCost(const PlaneSighting& sighting) {
  auto* cost =
      new SightingCost<Width>{{sighting.position.x(), sighting.position.y(), sighting.heading.value_or(0)},
                              whitening(sighting.covariance.topLeftCorner<Width, Width>())};
  return new ceres::AutoDiffCostFunction<SightingCost<Width>, Width, 3, 3>(cost);
}

class SmoothingProblem {
 public:
  SmoothingProblem(const std::vector<DriveMoment>& drive, const DriveEstimate& start) {
    if (drive.size() != start.T_map_base.size())
      throw std::invalid_argument(std::to_string(drive.size()) + " moments need as many poses, not " +
                                  std::to_string(start.T_map_base.size()));
    for (const Pose2& pose : start.T_map_base)
      poses_.push_back({pose.position.x(), pose.position.y(), pose.heading});
    for (const PlaneLandmark& landmark : start.landmarks)
      landmarks_.push_back({landmark.position.x(), landmark.position.y(), landmark.heading.value_or(0)});
    for (size_t i = 0; i < drive.size(); ++i) {
      if (i > 0) addStep(i, drive[i].step);
      for (const KnownSighting& each : drive[i].seen) addSighting(i, each, start);
    }
    if (!poses_.empty() && problem_.HasParameterBlock(poses_[0].data()))
      problem_.SetParameterBlockConstant(poses_[0].data());
  }

  std::optional<double> solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = kMaxIterations;
    options.function_tolerance = 1e-12;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable()) return {};
    return summary.final_cost;
  }

  DriveEstimate estimate(const DriveEstimate& start) const {
    DriveEstimate found;
    for (const Block& pose : poses_) found.T_map_base.push_back({{pose[0], pose[1]}, wrapped(pose[2])});
    for (size_t i = 0; i < landmarks_.size(); ++i) {
      found.landmarks.push_back({{landmarks_[i][0], landmarks_[i][1]}, {}});
      if (start.landmarks[i].heading) found.landmarks.back().heading = wrapped(landmarks_[i][2]);
    }
    return found;
  }

 private:
  void addStep(size_t moment, const OdometryStep& step) {
    auto* cost = new StepCost{step.step, whitening(step.noise)};
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<StepCost, 3, 3, 3>(cost), nullptr,
                              poses_[moment - 1].data(), poses_[moment].data());
  }

  void addSighting(size_t moment, const KnownSighting& seen, const DriveEstimate& start) {
    if (seen.landmark >= landmarks_.size())
      throw std::invalid_argument("a sighting is of landmark " + std::to_string(seen.landmark) +
                                  ", which is not there");
    const bool with_heading = commonWidth(seen.sighting, start.landmarks[seen.landmark]) == 3;
    problem_.AddResidualBlock(with_heading ? sightingCost<3>(seen.sighting) : sightingCost<2>(seen.sighting),
                              nullptr, poses_[moment].data(), landmarks_[seen.landmark].data());
  }

  std::vector<Block> poses_, landmarks_;
  ceres::Problem problem_;
};

}  // namespace

std::optional<SmoothedDrive> smoothDrive(const std::vector<DriveMoment>& drive, const DriveEstimate& start) {
  SmoothingProblem problem(drive, start);
  const auto cost = problem.solve();
  if (!cost) return {};
  return SmoothedDrive{problem.estimate(start), *cost};
}

}  // namespace sextant
