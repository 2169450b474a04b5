// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/locator_report.hpp"

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

using diagnostic_msgs::DiagnosticStatus;

std::string nameOf(const MarkerKey& key) { return key.family + "/" + std::to_string(key.id); }

}  // namespace

void LocatorReport::result(const LocatorResult& result, bool nothing_seen) {
  for (const MarkerKey& key : result.unmapped) ++unmapped_[key];
  for (const MarkerKey& key : result.repeated)
    trouble_.report("repeated marker",
                    "marker " + std::to_string(key.id) + " (" + key.family +
                        ") is in one image more than once and is left out: hang each id once");
  seen_ = (result.pose ? result.pose->markers.size() : 0) + result.unmapped.size();
  used_ = 0;
  if (result.pose) {
    ++poses_;
    used_ = result.pose->used().size();
    reprojection_error_ = result.pose->reprojection_error;
    trouble_.succeeded();
    return;
  }
  ++reasons_[result.reason];
  if (nothing_seen)
    trouble_.succeeded();
  else
    trouble_.report("markers in vain", "no pose: " + result.reason);
}

void LocatorReport::published(double latency) {
  ++rate_poses_;
  latency_sum_ += latency;
  latency_most_ = std::max(latency_most_, latency);
}

void LocatorReport::fill(diagnostic_updater::DiagnosticStatusWrapper& status,
                         const MarkerLocalization& localization, const MarkerMap* map,
                         const std::vector<std::string>& cameras) {
  trouble_.fill(status);
  if (!map)
    status.summary(DiagnosticStatus::WARN, "no marker map yet");
  else if (images_ == 0)
    status.summary(DiagnosticStatus::WARN, "no markers on " + cameras.front());
  status.add("images", images_);
  status.add("poses", poses_);
  fillRate(status);
  status.add("mapped markers in the last image", seen_);
  status.add("of these used", used_);
  status.add("reprojection error (px)", reprojection_error_);
  for (size_t i = 0; i < cameras.size(); ++i)
    status.addf("corner noise on " + cameras[i] + " (px)", "%.3f",
                localization.params().locator.corner_sigma * localization.noise().scale(i));
  status.add("markers in the map", map ? map->markers().size() : 0);
  for (const auto& [reason, count] : reasons_) status.add("no pose: " + reason, count);
  for (const auto& [key, count] : unmapped_) status.add("not in the map: " + nameOf(key), count);
  fillMoved(status, localization);
}

void LocatorReport::fillRate(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  const double period = (now - rate_begin_).toSec();
  status.addf("rate (Hz)", "%.1f", period > 0 ? rate_poses_ / period : 0.0);
  if (rate_poses_ > 0) {
    status.addf("latency since the image's stamp: mean ms", "%.1f", 1e3 * latency_sum_ / rate_poses_);
    status.addf("latency since the image's stamp: max ms", "%.1f", 1e3 * latency_most_);
  }
  rate_begin_ = now;
  rate_poses_ = 0;
  latency_sum_ = latency_most_ = 0.0;
}

void LocatorReport::fillMoved(diagnostic_updater::DiagnosticStatusWrapper& status,
                              const MarkerLocalization& localization) {
  for (const MovedMarker& marker : localization.watch().moved()) {
    const Eigen::Vector3d& offset = marker.offset;
    const std::string text = "marker " + std::to_string(marker.key.id) + " (" + marker.key.family +
                             ") stands " + std::to_string(std::lround(100 * offset.norm())) +
                             " cm from where the map has it";
    status.mergeSummary(DiagnosticStatus::WARN, text);
    status.addf("seen elsewhere than in the map: " + nameOf(marker.key),
                "by %.3f %.3f %.3f m, left out of %d images", offset.x(), offset.y(), offset.z(),
                marker.images);
  }
}

}  // namespace sextant
