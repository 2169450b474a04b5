// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sextant {

using Indices = std::vector<Eigen::Index>;

/// Symmetric matrix of variable size that stores its lower triangle. Low-rank updates are buffered and
/// applied in one pass, because memory bandwidth limits the speed, not arithmetic.
class CovarianceStore {
 public:
  /// Copies a symmetric matrix.
  explicit CovarianceStore(const Eigen::MatrixXd& matrix = {}) { assign(matrix); }

  Eigen::Index size() const { return lower_.rows(); }       ///< rows
  double operator()(Eigen::Index i, Eigen::Index j) const;  ///< one element

  Eigen::MatrixXd columns(const Indices& indices) const;  ///< (size, k) for k indices
  Eigen::MatrixXd block(const Indices& indices) const;    ///< (k, k) for k indices
  Eigen::MatrixXd full() const;                           ///< (size, size)

  void addSquare(const Eigen::MatrixXd& W, double sign = 1);  ///< adds sign * W W^T; W is (size, any)
  void setColumns(const Indices& indices, const Eigen::MatrixXd& columns);  ///< columns are (size, k)
  void append(const Eigen::MatrixXd& cross, const Eigen::MatrixXd& block);  ///< (added, size), (added, added)
  void erase(Eigen::Index first, Eigen::Index count);                       ///< rows and columns
  void assign(const Eigen::MatrixXd& matrix);                               ///< reads the lower triangle

 private:
  void applyPending();

  Eigen::MatrixXd lower_;
  Eigen::MatrixXd pending_;  // (size, kMaxPending) columns w whose sign * w w^T is still to be added
  Eigen::RowVectorXd signs_;
  Eigen::Index pending_count_ = 0;  // columns
};

}  // namespace sextant
