// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/latency_clock.hpp"

#include <algorithm>

namespace sextant {

void LatencyClock::published(const ros::Time& stamp, const ros::Time& now) {
  ++published_;
  if (stamp.isZero()) return;
  const double latency = now.toSec() - stamp.toSec();  // a ros::Duration has 31 bits
  longest_ = stamped_ == 0 ? latency : std::max(longest_, latency);
  ++stamped_;
  sum_ += latency;
}

void LatencyClock::fill(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  const double period = (now - begin_).toSec();
  status.addf("rate (Hz)", "%.1f", period > 0 ? published_ / period : 0.0);
  if (stamped_ > 0) {
    status.addf("latency since the image's stamp: mean ms", "%.1f", 1e3 * sum_ / stamped_);
    status.addf("latency since the image's stamp: max ms", "%.1f", 1e3 * longest_);
  }
  *this = LatencyClock();
}

}  // namespace sextant
