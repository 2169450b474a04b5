// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>

namespace sextant {

/// Which sigma points: Julier and Uhlmann's with kappa = 3 - n, scaled by Wan and van der Merwe's alpha and
/// beta. Then n + lambda = 3 alpha^2 whatever n is, so that dimensions that a function does not know change
/// nothing.
struct SigmaPointParams {
  double alpha = 0.1;  ///< spread: sqrt(3) alpha deviations, [1e-3, 1]
  double beta =
      2.0;  ///< adds what the mean moves, [1, 10]; 2: as of a normal variable, the nearer the smaller alpha

  /// @throws std::invalid_argument that names the first field out of range.
  void validate() const;
};

/// A function of a normal variable x = mean + L u, with u of unit covariance.
struct UnscentedMoments {
  Eigen::VectorXd mean;        ///< (k)
  Eigen::MatrixXd covariance;  ///< (k, k)
  Eigen::MatrixXd slopes;      ///< (k, n) along the columns of L: the covariance with x is L slopes^T
};

/// @param L (n, n) lower Cholesky factor of the covariance of x
/// @param function of x - mean, (n) to (k)
UnscentedMoments unscentedTransform(const Eigen::MatrixXd& L, const SigmaPointParams& params,
                                    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& function);

}  // namespace sextant
