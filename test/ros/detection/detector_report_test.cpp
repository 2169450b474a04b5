// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/detection/detector_report.hpp"

#include <gtest/gtest.h>

#include <map>

namespace sextant {
namespace {

ObservedMarker marker(std::optional<double> reprojection_error) {
  ObservedMarker observed{Detection(), 0.2, {}, {}};
  if (reprojection_error) observed.poses = PlanarPoses{{Pose::Identity(), *reprojection_error}, {}};
  return observed;
}

std::map<std::string, double> rows(DetectorReport& report) {
  diagnostic_updater::DiagnosticStatusWrapper status;
  report.fill(status);
  std::map<std::string, double> all;
  for (const auto& row : status.values) all[row.key] = std::stod(row.value);
  return all;
}

TEST(DetectorReport, SharesAreOfTheImagesSinceTheLastReport) {
  DetectorReport report;
  for (int i = 0; i < 8; ++i) report.image();
  const ros::Time now(3.0);
  report.published({marker(0.3), marker(0.4)}, now, now);
  report.published({}, now, now);
  const auto first = rows(report);
  EXPECT_EQ(first.at("images"), 8);
  EXPECT_EQ(first.at("images not used (%)"), 75.0);
  EXPECT_EQ(first.at("images without a marker (%)"), 50.0);
  EXPECT_EQ(first.at("markers per image: mean"), 1.0);
  EXPECT_EQ(first.at("markers in the last image"), 0);
  EXPECT_NEAR(first.at("reprojection error, each marker on its own: RMS (px)"), 0.354,
              1e-9);  // root of 0.125
  report.image();
  report.published({marker(0.1), marker({})}, now, now);
  const auto second = rows(report);
  EXPECT_EQ(second.at("images"), 9);
  EXPECT_EQ(second.at("images not used (%)"), 0.0);
  EXPECT_EQ(second.at("markers without a pose"), 1);
  EXPECT_EQ(second.at("reprojection error, each marker on its own: RMS (px)"), 0.1);
}

TEST(DetectorReport, NothingHappened) {
  DetectorReport report;
  const auto entries = rows(report);
  EXPECT_EQ(entries.at("images not used (%)"), 0.0);
  EXPECT_EQ(entries.count("markers per image: mean"), 0u);
}

}  // namespace
}  // namespace sextant
