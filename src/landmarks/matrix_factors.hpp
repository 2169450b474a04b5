// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace sextant {

/// L^-1 B for a lower triangle L.
Eigen::MatrixXd lowerInverseTimes(const Eigen::MatrixXd& L, const Eigen::MatrixXd& B);

/// The largest variance of a covariance in units of another one's, whose factor is given.
double largestRatio(const Eigen::MatrixXd& covariance, const Eigen::LLT<Eigen::MatrixXd>& unit);

/// A with A A^T = the matrix, which may have no rank.
Eigen::Matrix3d squareRoot(const Eigen::Matrix3d& matrix);

}  // namespace sextant
