// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>

namespace sextant {

/// A function of a normal variable x = mean + L u, with u of unit covariance.
struct UnscentedMoments {
  Eigen::VectorXd mean;        ///< (k)
  Eigen::MatrixXd covariance;  ///< (k, k)
  Eigen::MatrixXd slopes;      ///< (k, n) along the columns of L: the covariance with x is L slopes^T
};

/// By Julier and Uhlmann's sigma points with kappa = 3 - n, scaled by Wan and van der Merwe's alpha = 0.1 and
/// beta = 2. Then n + lambda = 3 alpha^2 whatever n is, so that dimensions that a function does not know
/// change nothing.
/// @param L (n, n) lower Cholesky factor of the covariance of x
/// @param function of x - mean, (n) to (k)
UnscentedMoments unscentedTransform(const Eigen::MatrixXd& L,
                                    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& function);

}  // namespace sextant
