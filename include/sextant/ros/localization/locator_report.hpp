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

/// What a locator tells of its work: in the log what is wrong, in diagnostics everything.
class LocatorReport {
 public:
  explicit LocatorReport(TroubleLog& trouble) : trouble_(trouble) {}

  void image() { ++images_; }
  /// @param nothing_seen no marker in any image: no reason to complain
  void result(const LocatorResult& result, bool nothing_seen);
  /// A pose that was published. @param stamp of its image
  void published(const ros::Time& stamp, const ros::Time& now) { latency_.published(stamp, now); }

  /// @param map nothing: none has come yet; @param cameras topics
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status, const MarkerLocalization& localization,
            const MarkerMap* map, const std::vector<std::string>& cameras);

 private:
  struct Residuals {
    double squares = 0.0;  // of coordinates, in deviations
    unsigned long images = 0;
  };
  void addResiduals(const LocatedPose& pose);
  void fillResiduals(diagnostic_updater::DiagnosticStatusWrapper& status);
  void fillMoved(diagnostic_updater::DiagnosticStatusWrapper& status, const MarkerLocalization& localization);

  TroubleLog& trouble_;
  unsigned long images_ = 0, poses_ = 0;
  size_t seen_ = 0, used_ = 0;
  double reprojection_error_ = 0.0;
  std::map<std::string, unsigned long> reasons_;
  std::map<MarkerKey, unsigned long> unmapped_;
  std::map<MarkerKey, Residuals> residuals_;  // since the last report
  LatencyClock latency_;
};

}  // namespace sextant
