// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/localization/locator_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
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

  LocatedPose pose;
  pose.T_map_base.setIdentity();
  pose.covariance.setIdentity();
  report.result({pose, "", {}, {}, {}}, 3);
  all = rows(report);
  EXPECT_EQ(all.at("markers in the last image"), "3");
  EXPECT_EQ(all.at("poses"), "1");
}

TEST(LocatorReport, ErrorsAreExplainedWithWhatToDo) {
  const auto text = [](ErrorCause cause, const Eigen::VectorXd& value, const Eigen::VectorXd& sigma) {
    return explained({cause, 0, value, sigma});
  };
  const auto one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
  EXPECT_EQ(text(ErrorCause::focal_length, one(0.0102), one(0.002)),
            "focal length about 1.0 ± 0.2 % too short: run check_calibration");
  EXPECT_EQ(text(ErrorCause::focal_length, one(-0.0102), one(0.002)),
            "focal length about 1.0 ± 0.2 % too long: run check_calibration");
  EXPECT_EQ(text(ErrorCause::shutter, one(0.0204), one(0.001)),
            "rolling shutter: readout_time is wrong by about 20 ± 1 ms");
  EXPECT_EQ(text(ErrorCause::centre, Eigen::Vector2d(3, -4), Eigen::Vector2d(0.2, 0.3)),
            "principal point about 5.0 ± 0.3 pixels off: run check_calibration");
  EXPECT_EQ(text(ErrorCause::marker_size, one(std::log(1.02)), one(0.001)),
            "markers about 2.0 ± 0.1 % larger than in the map: measure them");
  EXPECT_EQ(text(ErrorCause::map, Eigen::Vector2d(0.021, 0.0175), Eigen::Vector2d(0, 0)),
            "markers about 2.1 cm (and 1.0 degrees) from their positions in the map: map them again");
}

}  // namespace
}  // namespace sextant
