// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/noise_monitor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace sextant {
namespace {

constexpr double kLeast = 0.05, kMost = 100;  // bounds of the factors
constexpr double kOutlier = 8;                // times its mean, at which a normalized innovation is cut
constexpr double kForgetting = 0.9995;        // of the information, with each scan

}  // namespace

double NoiseMonitor::applied() const { return std::max(1.0, odometry()); }

void NoiseMonitor::add(double nis, int dof, double share) {
  if (dof < 1) return;
  const Eigen::Vector2d row(share / applied(), 1 - share);
  const double mean = row.dot(factors_);
  // The variance of a chi-squared variable is twice its degrees of freedom.
  const double weight = dof / (2 * mean * mean), value = std::min(nis / dof, kOutlier * mean);
  const Eigen::Matrix2d prior = Eigen::Matrix2d::Identity() * kPrior;
  information_ = prior + kForgetting * (information_ - prior) + weight * row * row.transpose();
  sum_ = Eigen::Vector2d::Constant(kPrior) + kForgetting * (sum_ - Eigen::Vector2d::Constant(kPrior)) +
         weight * value * row;
  factors_ = information_.llt().solve(sum_).cwiseMax(kLeast).cwiseMin(kMost);
}

}  // namespace sextant
