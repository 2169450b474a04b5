// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/localization/locator_report.hpp"

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <cmath>
#include <cstdio>

namespace sextant {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kCoordinates = 8.0;  // of a marker's four corners
constexpr double kGoodMap = 0.003;    // m; smaller errors of a map are not reported
constexpr double kArm = 0.3;          // m; rotation that is as bad as such an error

std::string nameOf(const MarkerKey& key) { return key.family + "/" + std::to_string(key.id); }

std::string printed(const char* format, double value, double sigma) {
  char text[200];
  std::snprintf(text, sizeof text, format, value, sigma);
  return text;
}

bool isOfCamera(ErrorCause cause) { return cause != ErrorCause::marker_size && cause != ErrorCause::map; }

}  // namespace

std::string explained(const SystematicError& error) {
  const double value = error.value[0], sigma = error.sigma[0];
  switch (error.cause) {
    case ErrorCause::focal_length:
      return printed(value > 0 ? "focal length about %.1f ± %.1f %% too short: run check_calibration"
                               : "focal length about %.1f ± %.1f %% too long: run check_calibration",
                     100 * std::abs(value), 100 * sigma);
    case ErrorCause::centre:
      return printed("principal point about %.1f ± %.1f pixels off: run check_calibration",
                     error.value.norm(), error.sigma.maxCoeff());
    case ErrorCause::distortion:
      return printed("distortion k1 off by about %.3f ± %.3f: run check_calibration", value, sigma);
    case ErrorCause::shutter:
      return printed("rolling shutter: readout_time is wrong by about %.0f ± %.0f ms", 1000 * value,
                     1000 * sigma);
    case ErrorCause::marker_size:
      return printed(value > 0 ? "markers about %.1f ± %.1f %% larger than in the map: measure them"
                               : "markers about %.1f ± %.1f %% smaller than in the map: measure them",
                     100 * std::abs(std::expm1(value)), 100 * sigma);
    case ErrorCause::map:
      break;
  }
  return printed("markers about %.1f cm (and %.1f degrees) from their positions in the map: map them again",
                 100 * value, error.value[1] * 180 / M_PI);
}

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
  fillErrors(status, localization, cameras);
}

void LocatorReport::fillErrors(diagnostic_updater::DiagnosticStatusWrapper& status,
                               const MarkerLocalization& localization,
                               const std::vector<std::string>& cameras) {
  for (const SystematicError& error : localization.errors().errors()) {
    if (error.cause == ErrorCause::map && error.value[0] < kGoodMap && error.value[1] < kGoodMap / kArm)
      continue;
    const bool has_name = isOfCamera(error.cause) && error.camera < cameras.size();
    status.mergeSummary(DiagnosticStatus::WARN,
                        (has_name ? cameras[error.camera] + ": " : "") + explained(error));
  }
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
