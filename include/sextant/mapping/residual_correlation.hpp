// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

namespace sextant {

/// Residuals of one marker in one camera, by the number of the image.
using ResidualSeries = std::map<size_t, Eigen::Matrix<double, 8, 1>>;

/// How many images in a row say as much as one, because lens, print and light err alike in them: the
/// integrated autocorrelation time 1 + 2 sum(rho_k), cut where the correlation is lost (Sokal 1997, "Monte
/// Carlo methods in statistical mechanics", section 3). 1 for independent noise, and where there is nothing
/// to tell from.
double correlatedImages(const std::vector<ResidualSeries>& all);

}  // namespace sextant
