// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/unscented_transform.hpp"

#include <cmath>

#include "sextant/base/range.hpp"

namespace sextant {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// beta >= alpha^2: then no covariance is indefinite, whatever the function.
void SigmaPointParams::validate() const {
  Range::closed(1e-3, 1).require("alpha", alpha);
  Range::closed(1, 10).require("beta", beta);
}

// Julier and Uhlmann 2004, "Unscented filtering and nonlinear estimation"; Wan and van der Merwe 2000,
// eq. 15.
UnscentedMoments unscentedTransform(const MatrixXd& L, const SigmaPointParams& params,
                                    const std::function<VectorXd(const VectorXd&)>& function) {
  const Index n = L.cols();
  const double scaled = 3 * params.alpha * params.alpha, spread = std::sqrt(scaled), weight = 0.5 / scaled;
  const double centre_mean = 1 - n / scaled;
  const double centre_covariance = centre_mean + 1 - params.alpha * params.alpha + params.beta;

  const VectorXd centre = function(VectorXd::Zero(L.rows()));
  MatrixXd above(centre.size(), n), below(centre.size(), n);  // of the centre
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
