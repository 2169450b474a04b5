// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/covariance_store.hpp"

#include <gtest/gtest.h>

#include "test_matrices.hpp"

namespace sextant {
namespace {

using Eigen::MatrixXd;

MatrixXd symmetric(int size) {
  srand(size);
  const MatrixXd A = MatrixXd::Random(size, size);
  return A * A.transpose();
}

TEST(CovarianceStore, IsTheDenseMatrix) {
  const MatrixXd dense = symmetric(7);
  const CovarianceStore store(dense.triangularView<Eigen::Lower>());  // nothing above the diagonal
  const Indices which{4, 0, 6};
  EXPECT_TRUE(store.full().isApprox(dense));
  EXPECT_TRUE(store.columns(which).isApprox(pickedColumns(dense, which)));
  EXPECT_TRUE(store.block(which).isApprox(picked(dense, which, which)));
  EXPECT_EQ(store(2, 5), dense(5, 2));
}

TEST(CovarianceStore, ChangesAsTheDenseMatrixDoes) {
  MatrixXd dense = symmetric(6);
  CovarianceStore store(dense);
  const MatrixXd W = MatrixXd::Random(6, 2);
  store.addSquare(W, -0.5);
  dense -= 0.5 * W * W.transpose();
  EXPECT_TRUE(store.full().isApprox(dense));

  const Indices which{5, 1};
  MatrixXd changed = dense;
  MatrixXd columns = MatrixXd::Random(6, 2);
  columns(1, 0) = columns(5, 1);
  for (int k = 0; k < 2; ++k)
    changed.col(which[k]) = columns.col(k), changed.row(which[k]) = columns.col(k).transpose();
  store.setColumns(which, columns);
  EXPECT_TRUE(store.full().isApprox(changed));
}

TEST(CovarianceStore, GrowsAndShrinks) {
  const MatrixXd all = symmetric(8);
  CovarianceStore store(all.topLeftCorner(5, 5));
  store.append(all.bottomLeftCorner(3, 5), all.bottomRightCorner(3, 3));
  EXPECT_TRUE(store.full().isApprox(all));
  store.erase(2, 3);
  const Indices left{0, 1, 5, 6, 7};
  EXPECT_TRUE(store.full().isApprox(picked(all, left, left)));
  store.erase(3, 2);
  EXPECT_TRUE(store.full().isApprox(picked(all, {0, 1, 5}, {0, 1, 5})));
}

void expectSame(const CovarianceStore& store, const MatrixXd& dense) {
  const Indices which{dense.rows() - 1, 0, 3};
  ASSERT_EQ(store.size(), dense.rows());
  EXPECT_LT((store.columns(which) - pickedColumns(dense, which)).norm(), 1e-10);
  EXPECT_LT((store.block(which) - picked(dense, which, which)).norm(), 1e-10);
  EXPECT_LT((store.full() - dense).norm(), 1e-10);
  EXPECT_NEAR(store(1, 3), dense(3, 1), 1e-10);
}

// Updates are buffered up to 32 columns; results include them.
TEST(CovarianceStore, PendingUpdatesAreInEveryResult) {
  MatrixXd dense = symmetric(9);
  CovarianceStore store(dense);
  for (const int columns : {1, 5, 3, 20, 2, 1, 32, 1, 33, 40, 7, 0, 31, 2}) {
    const MatrixXd W = MatrixXd::Random(9, columns);
    const double sign = columns % 2 ? -0.5 : 1;
    store.addSquare(W, sign);
    dense += sign * W * W.transpose();
    expectSame(store, dense);
    const CovarianceStore copy(store);
    expectSame(copy, dense);
  }
}

// One after another: a row of the dense matrix for everything that may be done to the store.
TEST(CovarianceStore, PendingUpdatesAreAppliedBeforeChanges) {
  MatrixXd dense = symmetric(9);
  CovarianceStore store(dense);
  for (int round = 0; round < 12; ++round) {
    const MatrixXd W = MatrixXd::Random(dense.rows(), 3 + round);
    store.addSquare(W, round % 2 ? -1 : 1);
    dense += (round % 2 ? -1 : 1) * W * W.transpose();
    if (round % 4 == 0) {
      const Eigen::Index size = dense.rows();
      const MatrixXd cross = MatrixXd::Random(2, size), block = symmetric(2);
      store.append(cross, block);
      dense.conservativeResize(size + 2, size + 2);
      dense.bottomLeftCorner(2, size) = cross;
      dense.topRightCorner(size, 2) = cross.transpose();
      dense.bottomRightCorner(2, 2) = block;
    } else if (round % 4 == 1) {
      store.erase(round % 5, 1);
      Indices left;
      for (Eigen::Index i = 0; i < dense.rows(); ++i)
        if (i != round % 5) left.push_back(i);
      dense = picked(dense, left, left);
    } else if (round % 4 == 2) {
      const MatrixXd column = MatrixXd::Random(dense.rows(), 1);
      store.setColumns({4}, column);
      dense.col(4) = column, dense.row(4) = column.transpose();
    }
    expectSame(store, dense);
  }
  store.addSquare(MatrixXd::Random(dense.rows(), 4));
  store.assign(symmetric(5));
  expectSame(store, symmetric(5));
}

}  // namespace
}  // namespace sextant
