// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sextant {

/// The given rows and columns of a matrix; Eigen 3.3 has no indexed views.
inline Eigen::MatrixXd picked(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& rows,
                              const std::vector<Eigen::Index>& columns) {
  Eigen::MatrixXd found(rows.size(), columns.size());
  for (size_t i = 0; i < rows.size(); ++i)
    for (size_t j = 0; j < columns.size(); ++j) found(i, j) = matrix(rows[i], columns[j]);
  return found;
}

/// The given columns of a matrix.
inline Eigen::MatrixXd pickedColumns(const Eigen::MatrixXd& matrix,
                                     const std::vector<Eigen::Index>& columns) {
  std::vector<Eigen::Index> rows(matrix.rows());
  for (size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<Eigen::Index>(i);
  return picked(matrix, rows, columns);
}

}  // namespace sextant
