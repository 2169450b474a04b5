// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/covariance_store.hpp"

#include <algorithm>

namespace sextant {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr Index kMostPending = 32;  // columns

}  // namespace

double CovarianceStore::operator()(Index i, Index j) const {
  const auto of = [this](Index row) { return pending_.row(row).head(waiting_); };
  return lower_(std::max(i, j), std::min(i, j)) + of(i).cwiseProduct(signs_.head(waiting_)).dot(of(j));
}

MatrixXd CovarianceStore::columns(const Indices& which) const {
  MatrixXd found(size(), which.size());
  for (size_t k = 0; k < which.size(); ++k) {
    const Index at = which[k];
    found.col(k).head(at) = lower_.row(at).head(at).transpose();
    found.col(k).tail(size() - at) = lower_.col(at).tail(size() - at);
  }
  const MatrixXd signed_rows =
      pending_.leftCols(waiting_)(which, Eigen::all) * signs_.head(waiting_).asDiagonal();
  found.noalias() += pending_.leftCols(waiting_) * signed_rows.transpose();
  return found;
}

MatrixXd CovarianceStore::block(const Indices& which) const {
  MatrixXd found(which.size(), which.size());
  for (size_t k = 0; k < which.size(); ++k)
    for (size_t l = 0; l <= k; ++l) found(k, l) = found(l, k) = (*this)(which[k], which[l]);
  return found;
}

MatrixXd CovarianceStore::full() const {
  CovarianceStore copy(*this);
  copy.addPending();
  return copy.lower_.selfadjointView<Eigen::Lower>();
}

void CovarianceStore::addSquare(const MatrixXd& W, double sign) {
  if (waiting_ + W.cols() > kMostPending) addPending();
  if (W.cols() > kMostPending) {
    lower_.selfadjointView<Eigen::Lower>().rankUpdate(W, sign);
    return;
  }
  pending_.middleCols(waiting_, W.cols()) = W;
  signs_.segment(waiting_, W.cols()).setConstant(sign);
  waiting_ += W.cols();
}

void CovarianceStore::addPending() {
  const auto W = pending_.leftCols(waiting_);
  const MatrixXd signed_rows = signs_.head(waiting_).asDiagonal() * W.transpose();
  if (waiting_ > 0) lower_.triangularView<Eigen::Lower>() += W * signed_rows;
  waiting_ = 0;
}

void CovarianceStore::setColumns(const Indices& which, const MatrixXd& columns) {
  addPending();
  for (size_t k = 0; k < which.size(); ++k) {
    const Index at = which[k];
    lower_.row(at).head(at) = columns.col(k).head(at).transpose();
    lower_.col(at).tail(size() - at) = columns.col(k).tail(size() - at);
  }
}

void CovarianceStore::append(const MatrixXd& cross, const MatrixXd& block) {
  addPending();
  const Index old = size(), added = block.rows();
  lower_.conservativeResize(old + added, old + added);
  lower_.bottomLeftCorner(added, old) = cross;
  lower_.bottomRightCorner(added, added) = block;
  pending_.resize(size(), kMostPending);
}

void CovarianceStore::erase(Index first, Index count) {
  addPending();
  const Index after = size() - first - count;
  lower_.middleRows(first, after) = lower_.bottomRows(after).eval();
  lower_.middleCols(first, after) = lower_.rightCols(after).eval();
  lower_.conservativeResize(size() - count, size() - count);
  pending_.resize(size(), kMostPending);
}

void CovarianceStore::assign(const MatrixXd& matrix) {
  lower_ = matrix;
  pending_.resize(size(), kMostPending);
  signs_.resize(kMostPending);
  waiting_ = 0;
}

}  // namespace sextant
