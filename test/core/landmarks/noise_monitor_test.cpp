// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/noise_monitor.hpp"

#include <gtest/gtest.h>

#include <random>

namespace sextant {
namespace {

/// The monitor after scans whose true variances are so many times the stated ones. Every tenth scan comes
/// after a gap, in which the error of odometry grew by the factor that is applied to its noise.
NoiseMonitor after(int scans, double odometry, double observations) {
  NoiseMonitor monitor;
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1);
  for (int i = 0; i < scans; ++i) {
    const double share = i % 10 == 0 ? 0.95 : 0.1;
    const double mean = share * odometry / monitor.applied() + (1 - share) * observations;
    double nis = 0;
    for (int k = 0; k < 2; ++k) {
      const double innovation = std::sqrt(mean) * normal(random);
      nis += innovation * innovation;
    }
    monitor.add(nis, 2, share);
  }
  return monitor;
}

TEST(NoiseMonitor, NothingIsWrongAtFirst) {
  const NoiseMonitor monitor;
  EXPECT_EQ(monitor.odometry(), 1);
  EXPECT_EQ(monitor.observations(), 1);
  EXPECT_EQ(monitor.applied(), 1);
}

TEST(NoiseMonitor, ConvergesToBothFactors) {
  for (const double odometry : {0.5, 1.0, 4.0})
    for (const double observations : {0.5, 1.0, 2.0}) {
      const NoiseMonitor monitor = after(3000, odometry, observations);
      EXPECT_NEAR(monitor.odometry() / odometry, 1, 0.3) << odometry << " " << observations;
      EXPECT_NEAR(monitor.observations() / observations, 1, 0.15) << odometry << " " << observations;
    }
}

TEST(NoiseMonitor, NeverAppliesLessThanWhatIsStated) {
  const NoiseMonitor monitor = after(3000, 0.3, 1);
  EXPECT_LT(monitor.odometry(), 0.6);
  EXPECT_EQ(monitor.applied(), 1);
}

TEST(NoiseMonitor, OneGrossErrorChangesLittle) {
  NoiseMonitor monitor = after(1000, 1, 1);
  const double before = monitor.observations();
  monitor.add(1e6, 2, 0.1);
  EXPECT_LT(monitor.observations(), before + 0.1);
  monitor.add(1, 0, 0.5);  // no degree of freedom
  EXPECT_LT(monitor.observations(), before + 0.1);
}

}  // namespace
}  // namespace sextant
