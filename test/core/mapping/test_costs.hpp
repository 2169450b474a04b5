// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

namespace sextant {

/// Residuals of a cost at its parameter blocks.
inline Eigen::VectorXd residualsOf(const ceres::CostFunction& cost,
                                   const std::vector<Eigen::VectorXd>& blocks, double** jacobians = nullptr) {
  std::vector<const double*> parameters;
  for (const Eigen::VectorXd& block : blocks) parameters.push_back(block.data());
  Eigen::VectorXd residuals(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(parameters.data(), residuals.data(), jacobians));
  return residuals;
}

/// Derivatives against central differences.
inline void expectDerivatives(const ceres::CostFunction& cost, const std::vector<Eigen::VectorXd>& blocks) {
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<Jacobian> jacobians;
  for (const Eigen::VectorXd& block : blocks) jacobians.emplace_back(cost.num_residuals(), block.size());
  std::vector<double*> rows;
  for (Jacobian& jacobian : jacobians) rows.push_back(jacobian.data());
  residualsOf(cost, blocks, rows.data());
  constexpr double kStep = 1e-6;
  for (size_t block = 0; block < blocks.size(); ++block)
    for (Eigen::Index i = 0; i < blocks[block].size(); ++i) {
      auto more = blocks, less = blocks;
      more[block][i] += kStep;
      less[block][i] -= kStep;
      const Eigen::VectorXd slope = (residualsOf(cost, more) - residualsOf(cost, less)) / (2 * kStep);
      const double scale = 1 + jacobians[block].norm();
      EXPECT_LT((slope - jacobians[block].col(i)).norm(), 1e-6 * scale) << block << ", " << i;
    }
}

}  // namespace sextant
