// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/eigen_solvers.hpp"

namespace Eigen {

template LLT<Matrix<double, 6, 6>>& LLT<Matrix<double, 6, 6>>::compute(
    const EigenBase<Matrix<double, 6, 6>>&);
template LDLT<Matrix<double, 6, 6>>& LDLT<Matrix<double, 6, 6>>::compute(
    const EigenBase<Matrix<double, 6, 6>>&);
template SelfAdjointEigenSolver<Matrix<double, 6, 6>>& SelfAdjointEigenSolver<Matrix<double, 6, 6>>::compute(
    const EigenBase<Matrix<double, 6, 6>>&, int);
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);

}  // namespace Eigen
