// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/time.h>

namespace sextant {

/// Publishing rate and latency since the image's stamp, for diagnostics. Replaces FrequencyStatus and
/// TimeStampStatus of diagnostic_updater: these report an error without a subscriber, a negative rate after
/// /clock jumps back, no rate while it stands, and no mean latency.
class LatencyClock {
 public:
  /// Counts a message. @param stamp of the image; zero: counts for the rate only
  void published(const ros::Time& stamp, const ros::Time& now);
  /// Adds the rate, and the mean and maximum latency since the last call, and restarts the measurement.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  unsigned long published_ = 0, stamped_ = 0;
  double sum_ = 0.0, longest_ = 0.0;  // seconds
  ros::SteadyTime begin_ = ros::SteadyTime::now();
};

}  // namespace sextant
