// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <vector>

#include "sextant/markers/observed_marker.hpp"
#include "sextant/ros/base/latency_clock.hpp"

namespace sextant {

/// Statistics of a detector for diagnostics; problems are reported by TroubleLog.
class DetectorReport {
 public:
  void image() { ++images_; }  ///< counts a received image
  /// Counts the markers of an image when they are published.
  void published(const std::vector<ObservedMarker>& markers, const ros::Time& stamp, const ros::Time& now);

  unsigned long images() const { return images_; }  ///< received since the start
  /// Adds counts since the start, and rates, percentages and means since the last call.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Period {
    unsigned long images_before = 0, used = 0, empty = 0, markers = 0, posed = 0;
    double squared_errors = 0.0;  // sum over the markers with a pose, pixels^2
  };
  void fillMarkers(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  unsigned long images_ = 0;
  size_t seen_ = 0;
  Period period_;
  LatencyClock latency_;
};

}  // namespace sextant
