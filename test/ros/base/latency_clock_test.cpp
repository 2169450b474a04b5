// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/latency_clock.hpp"

#include <gtest/gtest.h>

#include <map>

namespace sextant {
namespace {

std::map<std::string, double> rows(LatencyClock& clock) {
  diagnostic_updater::DiagnosticStatusWrapper status;
  clock.fill(status);
  std::map<std::string, double> all;
  for (const auto& row : status.values) all[row.key] = std::stod(row.value);
  return all;
}

TEST(LatencyClock, ReportsMeanAndLongestSinceTheLastReport) {
  LatencyClock clock;
  for (const double age : {0.010, 0.030, 0.020}) clock.published(ros::Time(5.0), ros::Time(5.0 + age));
  const auto first = rows(clock);
  EXPECT_NEAR(first.at("latency since the image's stamp: mean ms"), 20.0, 0.05);
  EXPECT_NEAR(first.at("latency since the image's stamp: max ms"), 30.0, 0.05);
  EXPECT_GT(first.at("rate (Hz)"), 0.0);
  const auto second = rows(clock);
  EXPECT_EQ(second.at("rate (Hz)"), 0.0);
  EXPECT_EQ(second.count("latency since the image's stamp: mean ms"), 0u);
}

TEST(LatencyClock, StampsAheadOfTheClockAreNegativeAndMissingOnesNotCounted) {
  LatencyClock clock;
  clock.published(ros::Time(5.0), ros::Time(4.99));
  clock.published(ros::Time(), ros::Time(7.0));
  const auto entries = rows(clock);
  EXPECT_NEAR(entries.at("latency since the image's stamp: mean ms"), -10.0, 0.05);
  EXPECT_NEAR(entries.at("latency since the image's stamp: max ms"), -10.0, 0.05);
  EXPECT_NO_THROW(clock.published(ros::Time(4294967295u, 0), ros::Time(5.0)));
}

}  // namespace
}  // namespace sextant
