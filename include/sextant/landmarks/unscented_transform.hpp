// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>

namespace sextant {

/// Moments of a function of a normal variable x = mean + L u, with u of unit covariance.
struct UnscentedMoments {
  Eigen::VectorXd mean;        ///< (k)
  Eigen::MatrixXd covariance;  ///< (k, k)
  Eigen::MatrixXd
      slopes;  ///< (k, n) statistical linearization along the columns of L; cov(x, f) = L slopes^T
};

/// Scaled unscented transform with kappa = 3 - n (Julier and Uhlmann), alpha = 0.1 and beta = 2 (Wan and van
/// der Merwe). Then n + lambda = 3 alpha^2 for every n: dimensions that the function does not depend on have
/// no effect.
/// @param L (n, n) lower Cholesky factor of the covariance of x
/// @param function of x - mean, from (n) to (k)
UnscentedMoments unscentedTransform(const Eigen::MatrixXd& L,
                                    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& function);

}  // namespace sextant
