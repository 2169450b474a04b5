// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

namespace sextant {

/// Residuals of one marker in one camera, by the number of the image.
using ResidualSeries = std::map<size_t, Eigen::Matrix<double, 8, 1>>;

/// Number of consecutive images that have as much information as one, because errors of lens, marker and
/// light are correlated: the integrated autocorrelation time 1 + 2 sum(rho_k), summed until the correlation
/// vanishes (Sokal 1997, "Monte Carlo methods in statistical mechanics", section 3). 1 for independent noise
/// or too few residuals. The parameters that were fitted to the residuals absorb more of correlated errors
/// than of independent ones; this is taken into account.
/// @param fitted number of fitted parameters that are common to many images
double correlatedImages(const std::vector<ResidualSeries>& all, double fitted);

}  // namespace sextant
