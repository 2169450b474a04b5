// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/detection/detector_report.hpp"

#include <cmath>

namespace sextant {
namespace {

double percent(unsigned long part, unsigned long whole) { return whole > 0 ? 100.0 * part / whole : 0.0; }

}  // namespace

void DetectorReport::published(const std::vector<ObservedMarker>& markers, const ros::Time& stamp,
                               const ros::Time& now) {
  latency_.published(stamp, now);
  seen_ = markers.size();
  ++period_.used;
  if (markers.empty()) ++period_.empty;
  period_.markers += markers.size();
  for (const ObservedMarker& marker : markers) {
    if (!marker.poses) continue;
    ++period_.posed;
    period_.squared_errors += std::pow(marker.poses->best.reprojection_error, 2);
  }
}

void DetectorReport::fill(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const unsigned long images = images_ - period_.images_before;
  status.add("images", images_);
  latency_.fill(status);
  status.addf("images not used (%)", "%.1f", percent(images - period_.used, images));
  fillMarkers(status);
  period_ = Period();
  period_.images_before = images_;
}

void DetectorReport::fillMarkers(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  status.add("markers in the last image", seen_);
  if (period_.used == 0) return;
  status.addf("markers per image: mean", "%.2f", static_cast<double>(period_.markers) / period_.used);
  status.addf("images without a marker (%)", "%.1f", percent(period_.empty, period_.used));
  if (period_.posed > 0)
    status.addf("reprojection error, each marker on its own: RMS (px)", "%.3f",
                std::sqrt(period_.squared_errors / period_.posed));
  if (period_.posed < period_.markers) status.add("markers without a pose", period_.markers - period_.posed);
}

}  // namespace sextant
