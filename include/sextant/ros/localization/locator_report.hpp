// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <map>
#include <string>
#include <vector>

#include "sextant/localization/marker_localization.hpp"
#include "sextant/ros/base/latency_clock.hpp"
#include "sextant/ros/base/trouble_log.hpp"

namespace sextant {

/// Returns what is wrong and what to do, for the user.
std::string explained(const SystematicError& error);

/// Reports on a locator: problems in the log, statistics in diagnostics.
class LocatorReport {
 public:
  /// Keeps a reference to the log.
  explicit LocatorReport(TroubleLog& trouble) : trouble_(trouble) {}

  void image() { ++images_; }  ///< counts a received image
  /// Counts a result. @param detected number of markers in all images; that there is none is not a problem
  void result(const LocatorResult& result, size_t detected);
  /// Counts a published pose. @param stamp of its image
  void published(const ros::Time& stamp, const ros::Time& now) { latency_.published(stamp, now); }

  /// Adds counts since the start, and rates and means since the last call.
  /// @param map nullptr: not received yet; @param cameras topics
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status, const MarkerLocalization& localization,
            const MarkerMap* map, const std::vector<std::string>& cameras);

 private:
  struct Residuals {
    double squares = 0.0;  // mean squared residual of a coordinate over its variance, summed over images
    unsigned long images = 0;
  };
  void fillErrors(diagnostic_updater::DiagnosticStatusWrapper& status, const MarkerLocalization& localization,
                  const std::vector<std::string>& cameras);
  void addResiduals(const LocatedPose& pose);
  void fillResiduals(diagnostic_updater::DiagnosticStatusWrapper& status);
  void fillMoved(diagnostic_updater::DiagnosticStatusWrapper& status, const MarkerLocalization& localization);

  TroubleLog& trouble_;
  unsigned long images_ = 0, poses_ = 0;
  size_t detected_ = 0, used_ = 0;
  double reprojection_error_ = 0.0;
  std::map<std::string, unsigned long> reasons_;
  std::map<MarkerKey, unsigned long> unmapped_;
  std::map<MarkerKey, Residuals> residuals_;  // since the last report
  LatencyClock latency_;
};

}  // namespace sextant
