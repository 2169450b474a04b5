// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/unscented_transform.hpp"

#include <cmath>

namespace sextant {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kAlpha = 0.1;  // spread of the sigma points: sqrt(3) alpha standard deviations
constexpr double kBeta =
    2.0;  // optimal for a normal variable; at least alpha^2, so that covariances are positive definite

}  // namespace

// Julier and Uhlmann 2004, "Unscented filtering and nonlinear estimation"; Wan and van der Merwe 2000,
// eq. 15.
UnscentedMoments unscentedTransform(const MatrixXd& L,
                                    const std::function<VectorXd(const VectorXd&)>& function) {
  const Index n = L.cols();
  const double scaled = 3 * kAlpha * kAlpha, spread = std::sqrt(scaled), weight = 0.5 / scaled;
  const double centre_mean = 1 - n / scaled;
  const double centre_covariance = centre_mean + 1 - kAlpha * kAlpha + kBeta;

  const VectorXd centre = function(VectorXd::Zero(L.rows()));
  MatrixXd above(centre.size(), n), below(centre.size(), n);  // sigma points less the centre
  for (Index i = 0; i < n; ++i) {
    above.col(i) = function(spread * L.col(i)) - centre;
    below.col(i) = function(-spread * L.col(i)) - centre;
  }
  const VectorXd shift = weight * (above + below).rowwise().sum();
  above.colwise() -= shift;
  below.colwise() -= shift;
  return {centre + shift,
          weight * (above * above.transpose() + below * below.transpose()) +
              centre_covariance * shift * shift.transpose(),
          weight * spread * (above - below)};
}

}  // namespace sextant
