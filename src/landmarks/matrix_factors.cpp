// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "matrix_factors.hpp"

#include <Eigen/Eigenvalues>

namespace sextant {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

MatrixXd lowerInverseTimes(const MatrixXd& L, const MatrixXd& B) {
  return L.triangularView<Eigen::Lower>().solve(B);
}

double largestRatio(const MatrixXd& covariance, const Eigen::LLT<MatrixXd>& unit) {
  const MatrixXd half = unit.matrixL().solve(covariance);
  const MatrixXd whole = unit.matrixL().solve(half.transpose());
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(whole, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

Matrix3d squareRoot(const Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> parts(matrix);
  return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace sextant
