// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/localization/locator_report.hpp"

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <cmath>

namespace sextant {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kCoordinates = 8.0;  // of a marker's four corners

std::string nameOf(const MarkerKey& key) { return key.family + "/" + std::to_string(key.id); }

}  // namespace

void LocatorReport::result(const LocatorResult& result, size_t detected) {
  for (const MarkerKey& key : result.unmapped) ++unmapped_[key];
  for (const MarkerKey& key : result.repeated)
    trouble_.report("repeated marker",
                    "marker " + std::to_string(key.id) + " (" + key.family +
                        ") was detected more than once in one image and is ignored: use each id only once");
  detected_ = detected;
  used_ = 0;
  if (result.pose) {
    ++poses_;
    used_ = result.pose->used().size();
    reprojection_error_ = result.pose->reprojection_error;
    addResiduals(*result.pose);
    trouble_.succeeded();
    return;
  }
  ++reasons_[result.reason];
  if (detected == 0)
    trouble_.succeeded();
  else
    trouble_.report("markers without a pose", "no pose: " + result.reason);
}

void LocatorReport::fill(diagnostic_updater::DiagnosticStatusWrapper& status,
                         const MarkerLocalization& localization, const MarkerMap* map,
                         const std::vector<std::string>& cameras) {
  trouble_.fill(status);
  if (!map)
    status.summary(DiagnosticStatus::WARN, "no marker map yet");
  else if (images_ == 0)
    status.summary(DiagnosticStatus::WARN, "no message received on " + cameras.front());
  status.add("images", images_);
  status.add("poses", poses_);
  latency_.fill(status);
  status.add("markers in the last image", detected_);
  status.add("mapped markers used in the last image", used_);
  status.add("reprojection error (px)", reprojection_error_);
  for (size_t i = 0; i < cameras.size(); ++i)
    status.addf("corner noise on " + cameras[i] + " (px)", "%.3f",
                localization.params().locator.corner_sigma * localization.noise().typical(i));
  status.add("markers in the map", map ? map->markers().size() : 0);
  for (const auto& [reason, count] : reasons_) status.add("no pose: " + reason, count);
  for (const auto& [key, count] : unmapped_) status.add("not in the map: " + nameOf(key), count);
  fillResiduals(status);
  fillMoved(status, localization);
}

void LocatorReport::addResiduals(const LocatedPose& pose) {
  for (const LocatedMarker& marker : pose.markers) {
    Residuals& residuals = residuals_[marker.key];
    residuals.squares += marker.squared_distance / kCoordinates;
    ++residuals.images;
  }
}

void LocatorReport::fillResiduals(diagnostic_updater::DiagnosticStatusWrapper& status) {
  for (const auto& [key, residuals] : residuals_)
    status.addf("residual against the map (standard deviations): " + nameOf(key), "%.2f",
                std::sqrt(residuals.squares / residuals.images));
  residuals_.clear();
}

void LocatorReport::fillMoved(diagnostic_updater::DiagnosticStatusWrapper& status,
                              const MarkerLocalization& localization) {
  for (const MovedMarker& marker : localization.movedMarkers().moved()) {
    const Eigen::Vector3d& offset = marker.offset;
    const std::string text = "marker " + std::to_string(marker.key.id) + " (" + marker.key.family + ") is " +
                             std::to_string(std::lround(100 * offset.norm())) +
                             " cm from its position in the map";
    status.mergeSummary(DiagnosticStatus::WARN, text);
    status.addf("moved from its position in the map: " + nameOf(marker.key), "%.3f %.3f %.3f m, in %d images",
                offset.x(), offset.y(), offset.z(), marker.images);
  }
}

}  // namespace sextant
