// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/time.h>

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "sextant/landmarks/landmark_timeline.hpp"
#include "sextant/landmarks/source_monitor.hpp"
#include "sextant/ros/base/latency_clock.hpp"
#include "sextant/ros/base/trouble_log.hpp"

namespace sextant {

/// Reports on SLAM: problems to the log, everything to diagnostics.
class LandmarkSlamReport {
 public:
  /// Keeps a reference to the log.
  explicit LandmarkSlamReport(TroubleLog& trouble) : trouble_(trouble) {}

  /// Records the arrival of a message, valid or not. @{
  void odometryReceived() { odometry_received_ = ros::SteadyTime::now(); }
  /// Notes the time of the last message of observations.
  void observationsReceived() { observations_received_ = ros::SteadyTime::now(); }
  /// @}
  /// Records the arrival of a scan. @param ahead of the newest odometry, seconds @param lag maximum delay,
  /// seconds
  void observations(const std::string& topic, Arrival arrival, double ahead, double lag);
  /// Records a scan or an image that was applied. @param now stamp of the newest odometry
  void applied(const LandmarkTimeline::Applied& applied, const ros::Time& now);

  /// The stamps begin again.
  void restarted() { sources_ = {}; }

  /// Records an image with too little content to recognize a place.
  void unusableImage(const ros::Time& stamp) { sources_.addUnusable(stamp.toSec()); }

  /// Fills the diagnostics. @param waiting number of waiting scans @param odometry, observations topics
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status, const LandmarkHypotheses& all,
            size_t waiting, const std::string& odometry, const std::string& observations);

 private:
  void fillLevel(diagnostic_updater::DiagnosticStatusWrapper& status, const LandmarkSlam& slam,
                 const std::string& odometry, const std::string& observations) const;
  static void fillCalibration(diagnostic_updater::DiagnosticStatusWrapper& status,
                              const LandmarkFilter& filter);
  void fillTotals(diagnostic_updater::DiagnosticStatusWrapper& status, size_t waiting) const;

  TroubleLog& trouble_;
  std::optional<ros::SteadyTime> odometry_received_, observations_received_;  // time of the last message
  unsigned long too_late_ = 0, duplicate_ = 0;
  std::map<PlaceUse, unsigned long> places_;  // number of images
  LandmarkReport totals_;
  SourceMonitor sources_;
  std::deque<std::pair<double, int>> nis_;  // with its degrees of freedom
  LatencyClock latency_;
};

}  // namespace sextant
