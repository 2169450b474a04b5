// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/covariance_store.hpp"

#include <algorithm>

namespace sextant {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr Index kMaxPending = 32;  // columns

}  // namespace

double CovarianceStore::operator()(Index i, Index j) const {
  const auto of = [this](Index row) { return pending_.row(row).head(pending_count_); };
  return lower_(std::max(i, j), std::min(i, j)) + of(i).cwiseProduct(signs_.head(pending_count_)).dot(of(j));
}

MatrixXd CovarianceStore::columns(const Indices& indices) const {
  MatrixXd found(size(), indices.size());
  for (size_t k = 0; k < indices.size(); ++k) {
    const Index at = indices[k];
    found.col(k).head(at) = lower_.row(at).head(at).transpose();
    found.col(k).tail(size() - at) = lower_.col(at).tail(size() - at);
  }
  MatrixXd signed_rows(indices.size(), pending_count_);
  for (size_t k = 0; k < indices.size(); ++k)
    signed_rows.row(k) =
        pending_.row(indices[k]).head(pending_count_).cwiseProduct(signs_.head(pending_count_));
  found.noalias() += pending_.leftCols(pending_count_) * signed_rows.transpose();
  return found;
}

MatrixXd CovarianceStore::block(const Indices& indices) const {
  MatrixXd found(indices.size(), indices.size());
  for (size_t k = 0; k < indices.size(); ++k)
    for (size_t l = 0; l <= k; ++l) found(k, l) = found(l, k) = (*this)(indices[k], indices[l]);
  return found;
}

MatrixXd CovarianceStore::full() const {
  CovarianceStore copy(*this);
  copy.applyPending();
  return copy.lower_.selfadjointView<Eigen::Lower>();
}

void CovarianceStore::addSquare(const MatrixXd& W, double sign) {
  if (pending_count_ + W.cols() > kMaxPending) applyPending();
  if (W.cols() > kMaxPending) {
    lower_.selfadjointView<Eigen::Lower>().rankUpdate(W, sign);
    return;
  }
  pending_.middleCols(pending_count_, W.cols()) = W;
  signs_.segment(pending_count_, W.cols()).setConstant(sign);
  pending_count_ += W.cols();
}

void CovarianceStore::applyPending() {
  const auto W = pending_.leftCols(pending_count_);
  const MatrixXd signed_rows = signs_.head(pending_count_).asDiagonal() * W.transpose();
  if (pending_count_ > 0) lower_.triangularView<Eigen::Lower>() += W * signed_rows;
  pending_count_ = 0;
}

void CovarianceStore::setColumns(const Indices& indices, const MatrixXd& columns) {
  applyPending();
  for (size_t k = 0; k < indices.size(); ++k) {
    const Index at = indices[k];
    lower_.row(at).head(at) = columns.col(k).head(at).transpose();
    lower_.col(at).tail(size() - at) = columns.col(k).tail(size() - at);
  }
}

void CovarianceStore::append(const MatrixXd& cross, const MatrixXd& block) {
  applyPending();
  const Index old = size(), added = block.rows();
  lower_.conservativeResize(old + added, old + added);
  lower_.bottomLeftCorner(added, old) = cross;
  lower_.bottomRightCorner(added, added) = block;
  pending_.resize(size(), kMaxPending);
}

void CovarianceStore::erase(Index first, Index count) {
  applyPending();
  const Index after = size() - first - count;
  lower_.middleRows(first, after) = lower_.bottomRows(after).eval();
  lower_.middleCols(first, after) = lower_.rightCols(after).eval();
  lower_.conservativeResize(size() - count, size() - count);
  pending_.resize(size(), kMaxPending);
}

void CovarianceStore::assign(const MatrixXd& matrix) {
  lower_ = matrix;
  pending_.resize(size(), kMaxPending);
  signs_.resize(kMaxPending);
  pending_count_ = 0;
}

}  // namespace sextant
