// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>

namespace sextant {

/// Covariance of the map's parameters at a minimum. The poses of the base are eliminated one after another
/// (Schur complement, Triggs et al. 2000, section 6), so that its time grows linearly with their number.
/// @param jacobian of the residuals over their standard deviations: six columns for each base pose, in order
/// of time, then those of the map. A row has entries of one base pose, of two consecutive ones, or of none.
/// @param bases number of base poses
/// @return nothing if the residuals do not determine every parameter
std::optional<Eigen::MatrixXd> mapParameterCovariance(
    const Eigen::SparseMatrix<double, Eigen::RowMajor>& jacobian, Eigen::Index bases);

}  // namespace sextant
