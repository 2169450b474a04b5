// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "matrix_factors.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

TEST(MatrixFactors, SolveALowerTriangleWhateverIsAboveIt) {
  MatrixXd L(2, 2), B(2, 1);
  L << 2, 99, 1, 4;
  B << 6, 11;
  EXPECT_TRUE(lowerInverseTimes(L, B).isApprox(Eigen::Vector2d(3, 2)));
}

TEST(MatrixFactors, TheLargestRatioIsThatOfTheWorstDirection) {
  MatrixXd unit(2, 2), turn(2, 2);
  unit << 4, 0, 0, 1;
  turn << 0.6, -0.8, 0.8, 0.6;
  const auto ratio = [](const MatrixXd& covariance, const MatrixXd& one) {
    return largestRatio(covariance, Eigen::LLT<MatrixXd>(one));
  };
  EXPECT_NEAR(ratio(3 * unit, unit), 3, 1e-12);
  EXPECT_NEAR(ratio(MatrixXd::Identity(2, 2), unit), 1, 1e-12);  // along the second axis
  MatrixXd covariance = MatrixXd::Zero(2, 2);
  covariance.diagonal() << 20, 2;  // 5 and 2 of the unit's
  EXPECT_NEAR(ratio(turn * covariance * turn.transpose(), turn * unit * turn.transpose()), 5, 1e-12);
}

TEST(MatrixFactors, ASquareRootNeedsNoRank) {
  const Eigen::Vector3d v(1, -2, 3), w(0, 1, 1);
  for (const Matrix3d& matrix : {Matrix3d(v * v.transpose()), Matrix3d(v * v.transpose() + w * w.transpose()),
                                 Matrix3d(Matrix3d::Identity()), Matrix3d(Matrix3d::Zero())}) {
    const Matrix3d A = squareRoot(matrix);
    EXPECT_LT((A * A.transpose() - matrix).norm(), 1e-14 + 1e-14 * matrix.norm());
  }
}

}  // namespace
}  // namespace sextant
