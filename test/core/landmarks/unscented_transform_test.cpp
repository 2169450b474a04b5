// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/unscented_transform.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

namespace sextant {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd lower(int size) {
  srand(size);
  const MatrixXd A = MatrixXd::Random(size, size);
  return (A * A.transpose() + MatrixXd::Identity(size, size)).llt().matrixL();
}

TEST(UnscentedTransform, ALinearFunctionIsExact) {
  const MatrixXd L = lower(5), A = MatrixXd::Random(3, 5);
  const VectorXd b = VectorXd::Random(3);
  const UnscentedMoments moments =
      unscentedTransform(L, [&](const VectorXd& x) -> VectorXd { return A * x + b; });
  EXPECT_TRUE(moments.mean.isApprox(b, 1e-8));
  EXPECT_TRUE(moments.covariance.isApprox(A * L * L.transpose() * A.transpose(), 1e-8));
  EXPECT_TRUE((L * moments.slopes.transpose()).isApprox(L * L.transpose() * A.transpose(), 1e-8));
}

// E[x^2] = s^2 is exact; the variance is 2 s^4 of a normal variable as alpha goes to 0.
TEST(UnscentedTransform, ASquareHasTheExactMeanAndAlmostTheVariance) {
  const double s = 0.7, alpha = 0.1;
  const UnscentedMoments moments = unscentedTransform(
      MatrixXd::Constant(1, 1, s), [](const VectorXd& x) -> VectorXd { return x.cwiseProduct(x); });
  EXPECT_NEAR(moments.mean(0), s * s, 1e-8);
  EXPECT_NEAR(moments.covariance(0, 0), (2 + 2 * alpha * alpha) * std::pow(s, 4), 1e-6);
}

TEST(UnscentedTransform, UnusedDimensionsHaveNoEffect) {
  const MatrixXd L = lower(6);
  const auto function = [](const VectorXd& x) -> VectorXd {
    return Eigen::Vector2d(std::sin(x(0)) * x(1), std::exp(0.3 * x(1)));
  };
  const UnscentedMoments all = unscentedTransform(L, function);
  const UnscentedMoments few = unscentedTransform(L.topLeftCorner(2, 2), function);
  EXPECT_TRUE(all.mean.isApprox(few.mean, 1e-9));
  EXPECT_TRUE(all.covariance.isApprox(few.covariance, 1e-9));
  EXPECT_TRUE(all.slopes.leftCols(2).isApprox(few.slopes, 1e-9));
  EXPECT_LT(all.slopes.rightCols(4).norm(), 1e-9);
}

}  // namespace
}  // namespace sextant
