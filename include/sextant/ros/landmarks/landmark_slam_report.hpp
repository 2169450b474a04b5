// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/time.h>

#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "sextant/landmarks/landmark_timeline.hpp"
#include "sextant/ros/base/latency_clock.hpp"
#include "sextant/ros/base/trouble_log.hpp"

namespace sextant {

/// What SLAM tells of its work: in the log what is wrong, in diagnostics everything.
class LandmarkSlamReport {
 public:
  explicit LandmarkSlamReport(TroubleLog& trouble) : trouble_(trouble) {}

  /// A message came, whether it can be used or not. @{
  void heardOdometry() { odometry_heard_ = ros::SteadyTime::now(); }
  void heardSightings() { sightings_heard_ = ros::SteadyTime::now(); }
  /// @}
  /// @param ahead of the newest odometry, seconds @param lag by which sightings may be late, seconds
  void sightings(const std::string& topic, Arrival arrival, double ahead, double lag);
  /// Sightings that came into the estimate. @param stamp of theirs; @param now odometry's then
  void applied(const LandmarkReport& report, const ros::Time& stamp, const ros::Time& now);

  /// @param odometry, sightings topics
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status, const LandmarkSlam& slam, size_t waiting,
            const std::string& odometry, const std::string& sightings);

 private:
  void fillLevel(diagnostic_updater::DiagnosticStatusWrapper& status, const LandmarkSlam& slam,
                 const std::string& odometry, const std::string& sightings) const;
  void fillTotals(diagnostic_updater::DiagnosticStatusWrapper& status, size_t waiting) const;

  TroubleLog& trouble_;
  std::optional<ros::SteadyTime> odometry_heard_, sightings_heard_;  // when the last came
  unsigned long too_late_ = 0, duplicate_ = 0;
  LandmarkReport totals_;
  std::deque<std::pair<double, int>> nis_;  // and its degrees of freedom
  LatencyClock latency_;
};

}  // namespace sextant
