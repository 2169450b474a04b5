// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/localization/locator_report.hpp"

#include <gtest/gtest.h>

#include <map>

namespace sextant {
namespace {

std::map<std::string, std::string> rows(LocatorReport& report) {
  diagnostic_updater::DiagnosticStatusWrapper status;
  report.fill(status, MarkerLocalization(LocalizationParams()), nullptr, {"markers"});
  std::map<std::string, std::string> all;
  for (const auto& row : status.values) all[row.key] = row.value;
  return all;
}

TEST(LocatorReport, UnmappedMarkersAreDetectedButNotUsed) {
  TroubleLog trouble("locator");
  LocatorReport report(trouble);
  LocatorResult result;
  result.reason = "no mapped marker";
  result.unmapped = {{"tag36h11", 5}, {"tag36h11", 7}};
  report.result(result, 2);
  auto all = rows(report);
  EXPECT_EQ(all.at("markers in the last image"), "2");
  EXPECT_EQ(all.at("mapped markers used in the last image"), "0");
  EXPECT_EQ(all.at("no pose: no mapped marker"), "1");
  EXPECT_EQ(all.at("not in the map: tag36h11/7"), "1");

  report.result({LocatedPose(), "", {}, {}}, 3);
  all = rows(report);
  EXPECT_EQ(all.at("markers in the last image"), "3");
  EXPECT_EQ(all.at("poses"), "1");
}

}  // namespace
}  // namespace sextant
