// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/time.h>

namespace sextant {

/// How often something is published and how old its image is then, for diagnostics. FrequencyStatus and
/// TimeStampStatus of diagnostic_updater set the summary: silence is an error there, also without a
/// subscriber; their rate is negative after /clock was set back and missing while it stands; they have no
/// mean latency.
class LatencyClock {
 public:
  /// @param stamp of the image; without one (zero) only the rate is counted
  void published(const ros::Time& stamp, const ros::Time& now);
  /// Rows for the rate, and for the mean and longest latency since the last report; begins anew.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  unsigned long published_ = 0, stamped_ = 0;
  double sum_ = 0.0, longest_ = 0.0;  // seconds
  ros::SteadyTime begin_ = ros::SteadyTime::now();
};

}  // namespace sextant
