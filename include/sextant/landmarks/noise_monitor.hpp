// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace sextant {

/// Estimates by which factors the stated variances of odometry and of observations are wrong. The squared
/// innovation, normalized by its stated covariance, has the mean
///   share * odometry / applied + (1 - share) * observations
/// where `share` of that covariance is of the state. After a gap without observations this share is nearly 1,
/// between two scans in quick succession nearly 0. Both factors are the weighted least-squares solution with
/// a prior of 1; old scans are forgotten slowly.
class NoiseMonitor {
 public:
  /// Adds the update with one scan.
  /// @param nis normalized innovation squared @param dof its degrees of freedom
  /// @param share of the state in the covariance of the innovation, in [0, 1]
  void add(double nis, int dof, double share);

  double odometry() const { return factors_(0); }      ///< factor of the variances of odometry
  double observations() const { return factors_(1); }  ///< factor of the variances of observations
  /// Factor that is applied to the variances of odometry: the estimate, and at least 1.
  double applied() const;

 private:
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Identity() * kPrior;
  Eigen::Vector2d sum_ = Eigen::Vector2d::Constant(kPrior), factors_{1, 1};

  static constexpr double kPrior = 4;  // information of the prior: a standard deviation of 0.5
};

}  // namespace sextant
