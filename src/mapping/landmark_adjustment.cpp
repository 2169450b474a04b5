// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/landmark_adjustment.hpp"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "landmark_costs.hpp"

namespace sextant {
namespace {

constexpr double kGrossDistance = 2.5;  // standard deviations beyond which a sighting counts less (Huber)
constexpr double kSlip = 100;           // squared standard deviations beyond which a robot was carried away
constexpr double kSlipScale = 1e6;      // factor of the variances then
constexpr int kMaxIterations = 100;
constexpr double kTolerance = 1e-9;  // least relative change of the cost

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

Pose2 poseOf(const PlanarBlock& block) { return {{block[0], block[1]}, wrapped(block[2])}; }

// Of a step: normal errors, or large ones if the robot was carried away.
class SlipLoss : public ceres::LossFunction {
 public:
  void Evaluate(double s, double rho[3]) const override {
    const double slip = kSlip + s / kSlipScale;
    const double ratio = std::exp(-0.5 * std::abs(s - slip));  // of the less likely one to the other
    const double normal = (s < slip ? 1 : ratio) / (1 + ratio);
    rho[0] = std::min(s, slip) - 2 * std::log1p(ratio);
    rho[1] = normal + (1 - normal) / kSlipScale;
    rho[2] = -0.5 * normal * (1 - normal) * (1 - 1 / kSlipScale) * (1 - 1 / kSlipScale);
  }
};

// The blocks and costs of one adjustment.
class Adjustment {
 public:
  Adjustment(const LandmarkDrives& measured, const LandmarkFilterParams& params,
             const AdjustedLandmarks& begin)
      : measured_(measured), begin_(begin), scalars_{begin.scale, begin.turn_scale, begin.bearing} {
    for (const Pose2& each : begin.poses)
      poses_.push_back({each.position.x(), each.position.y(), each.heading});
    for (const Landmark2D& each : begin.landmarks)
      landmarks_.push_back({each.position.x(), each.position.y(), each.heading.value_or(0.0)});
    addBlocks();
    addMeasurements();
    addScalars({params.scale_sigma, params.turn_scale_sigma, params.bearing_sigma});
  }

  void solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = kMaxIterations;
    options.function_tolerance = kTolerance;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable())
      throw std::runtime_error("the adjustment of the landmarks failed: " + summary.message);
  }

  AdjustedLandmarks result() {
    AdjustedLandmarks result;
    for (const PlanarBlock& each : poses_) result.poses.push_back(poseOf(each));
    for (size_t i = 0; i < landmarks_.size(); ++i) {
      const Pose2 pose = poseOf(landmarks_[i]);
      result.landmarks.push_back({pose.position, {}});
      if (begin_.landmarks[i].heading) result.landmarks.back().heading = pose.heading;
    }
    result.scale = scalars_[0];
    result.turn_scale = scalars_[1];
    result.bearing = scalars_[2];
    result.covariance = covariance();
    return result;
  }

 private:
  void addBlocks() {
    for (PlanarBlock& each : poses_) problem_.AddParameterBlock(each.data(), 3);
    for (size_t i = 0; i < landmarks_.size(); ++i)
      problem_.AddParameterBlock(landmarks_[i].data(), begin_.landmarks[i].dimension());
    for (double& each : scalars_) problem_.AddParameterBlock(&each, 1);
  }

  void addMeasurements() {
    for (const LandmarkDrives::Step& each : measured_.steps)
      problem_.AddResidualBlock(planarStepCost(each.odometry).release(),
                                each.may_slip ? new SlipLoss : nullptr, poses_.at(each.before).data(),
                                poses_.at(each.before + 1).data(), &scalars_[0], &scalars_[1]);
    for (const LandmarkDrives::Sighting& each : measured_.sightings)
      problem_.AddResidualBlock(sightingCost(each, begin_.landmarks.at(each.landmark)).release(),
                                new ceres::HuberLoss(kGrossDistance), poses_.at(each.pose).data(),
                                landmarks_.at(each.landmark).data(), &scalars_[2]);
    std::vector<double*> known;
    if (measured_.first_pose) known.push_back(poses_.at(0).data());
    for (size_t i = 0; i < measured_.known.size(); ++i) known.push_back(landmarks_.at(i).data());
    problem_.AddResidualBlock(knownLandmarksCost(measured_).release(), nullptr, known);
  }

  void addScalars(const std::array<double, 3>& sigmas) {
    const std::array<double, 3> expected{1, 1, 0};
    for (size_t i = 0; i < scalars_.size(); ++i) {
      is_estimated_[i] = sigmas[i] > 0;
      if (is_estimated_[i])
        problem_.AddResidualBlock(valueCost(expected[i], sigmas[i]).release(), nullptr, &scalars_[i]);
      else
        problem_.SetParameterBlockConstant(&scalars_[i]);
    }
  }

  // The last pose and the landmarks come last.
  std::vector<double*> variables() {
    std::vector<double*> all;
    for (size_t i = 0; i < scalars_.size(); ++i)
      if (is_estimated_[i]) all.push_back(&scalars_[i]);
    for (PlanarBlock& each : poses_) all.push_back(each.data());
    for (PlanarBlock& each : landmarks_) all.push_back(each.data());
    return all;
  }

  Eigen::MatrixXd covariance() {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = variables();
    ceres::CRSMatrix rows;
    problem_.Evaluate(options, nullptr, nullptr, nullptr, &rows);
    const Eigen::Map<const Sparse> jacobian(rows.num_rows, rows.num_cols,
                                            static_cast<Eigen::Index>(rows.values.size()), rows.rows.data(),
                                            rows.cols.data(), rows.values.data());
    const Eigen::SparseMatrix<double> information = jacobian.transpose() * jacobian;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> root(information);
    if (root.info() != Eigen::Success || root.vectorD().minCoeff() <= 0)
      throw std::runtime_error("the observations do not determine all poses and landmarks");
    Eigen::Index width = 3;
    for (const Landmark2D& each : begin_.landmarks) width += each.dimension();
    Eigen::MatrixXd result(width, width);
    for (Eigen::Index i = 0; i < width; ++i)
      result.col(i) = root.solve(Eigen::VectorXd::Unit(rows.num_cols, rows.num_cols - width + i)).tail(width);
    return result;
  }

  const LandmarkDrives& measured_;
  const AdjustedLandmarks& begin_;
  std::array<double, 3> scalars_;  // scale, turn scale, bearing
  std::array<bool, 3> is_estimated_{};
  std::vector<PlanarBlock> poses_, landmarks_;
  ceres::Problem problem_;
};

}  // namespace

AdjustedLandmarks adjustLandmarks(const LandmarkDrives& measured, const LandmarkFilterParams& params,
                                  const AdjustedLandmarks& begin) {
  Adjustment adjustment(measured, params, begin);
  adjustment.solve();
  return adjustment.result();
}

}  // namespace sextant
