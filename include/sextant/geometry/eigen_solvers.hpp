// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace Eigen {

// Solvers that many files use are compiled once, in eigen_solvers.cpp: each takes seconds to compile.
extern template LLT<Matrix<double, 6, 6>>& LLT<Matrix<double, 6, 6>>::compute(
    const EigenBase<Matrix<double, 6, 6>>&);
extern template LDLT<Matrix<double, 6, 6>>& LDLT<Matrix<double, 6, 6>>::compute(
    const EigenBase<Matrix<double, 6, 6>>&);
extern template SelfAdjointEigenSolver<Matrix<double, 6, 6>>&
SelfAdjointEigenSolver<Matrix<double, 6, 6>>::compute(const EigenBase<Matrix<double, 6, 6>>&, int);
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);

}  // namespace Eigen
