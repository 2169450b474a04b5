// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/residual_correlation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sextant {
namespace {

// x_k = rho x_{k-1} + noise: the correlation is rho^k.
ResidualSeries autoregressive(double rho, int images, int seed, size_t every = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  ResidualSeries series;
  Eigen::Matrix<double, 8, 1> x;
  for (int i = 0; i < x.size(); ++i) x(i) = noise(random);
  for (int i = 0; i < images; ++i) {
    for (int k = 0; k < x.size(); ++k) x(k) = rho * x(k) + std::sqrt(1 - rho * rho) * noise(random);
    series[every * i] = x;
  }
  return series;
}

TEST(CorrelatedImages, AreOneForIndependentNoise) {
  EXPECT_DOUBLE_EQ(correlatedImages({autoregressive(0, 2000, 1), autoregressive(0, 2000, 2)}, 0), 1.0);
}

// Closed form: 1 + 2 sum(rho^k) = (1 + rho) / (1 - rho).
TEST(CorrelatedImages, AreThoseOfAFirstOrderProcess) {
  for (const double rho : {0.5, 0.8, 0.9}) {
    std::vector<ResidualSeries> all;
    for (int seed = 0; seed < 6; ++seed) all.push_back(autoregressive(rho, 3000, seed));
    const double expected = (1 + rho) / (1 - rho);
    EXPECT_NEAR(correlatedImages(all, 0), expected, 0.12 * expected) << rho;
  }
}

// Series without their mean: eight fitted parameters each, which absorb the share time / 200 of the variance.
TEST(CorrelatedImages, ContainWhatTheFitAbsorbed) {
  const double rho = 0.8, time = (1 + rho) / (1 - rho);
  std::vector<ResidualSeries> all;
  for (int seed = 0; seed < 200; ++seed) {
    all.push_back(autoregressive(rho, 200, seed));
    Eigen::Matrix<double, 8, 1> mean = Eigen::Matrix<double, 8, 1>::Zero();
    for (const auto& each : all.back()) mean += each.second / 200;
    for (auto& each : all.back()) each.second -= mean;
  }
  const double without = correlatedImages(all, 0), with = correlatedImages(all, 8 * 200);
  EXPECT_NEAR(with / without, (1 - 1.0 / 200) / (1 - time / 200), 0.01);
  EXPECT_LT(std::abs(with - time), std::abs(without - time));
}

TEST(CorrelatedImages, AreOneWhereThereIsNothingToTellFrom) {
  EXPECT_DOUBLE_EQ(correlatedImages({}, 0), 1.0);
  EXPECT_DOUBLE_EQ(correlatedImages({autoregressive(0.9, 20, 1)}, 0), 1.0);
  EXPECT_DOUBLE_EQ(correlatedImages({autoregressive(0.9, 500, 1, 1000)}, 0),
                   1.0);  // never in neighbouring images
}

}  // namespace
}  // namespace sextant
