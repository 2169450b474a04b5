// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sextant {

using Indices = std::vector<Eigen::Index>;

/// A symmetric matrix that grows and shrinks, of which only the lower triangle is kept. What is added to all
/// of it waits until there is enough to go through it once: memory is slower than arithmetic.
class CovarianceStore {
 public:
  explicit CovarianceStore(const Eigen::MatrixXd& matrix = {}) { assign(matrix); }

  Eigen::Index size() const { return lower_.rows(); }
  double operator()(Eigen::Index i, Eigen::Index j) const;

  Eigen::MatrixXd columns(const Indices& which) const;  ///< (size, which)
  Eigen::MatrixXd block(const Indices& which) const;    ///< (which, which)
  Eigen::MatrixXd full() const;

  void addSquare(const Eigen::MatrixXd& W, double sign = 1);  ///< sign * W W^T; W is (size, any)
  void setColumns(const Indices& which, const Eigen::MatrixXd& columns);
  void append(const Eigen::MatrixXd& cross, const Eigen::MatrixXd& block);  ///< cross is (added, size)
  void erase(Eigen::Index first, Eigen::Index count);
  void assign(const Eigen::MatrixXd& matrix);

 private:
  void addPending();

  Eigen::MatrixXd lower_;
  Eigen::MatrixXd pending_;  // (size, most) columns w of which sign * w w^T is to be added
  Eigen::RowVectorXd signs_;
  Eigen::Index waiting_ = 0;  // columns
};

}  // namespace sextant
