// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/observed_marker.hpp"

#include <algorithm>
#include <stdexcept>

#include "sextant/base/range.hpp"
#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

bool namesMarker(const std::string& name) {
  const size_t slash = name.rfind('/');
  if (slash != std::string::npos) canonicalFamily(name.substr(0, slash));
  const std::string id = name.substr(slash == std::string::npos ? 0 : slash + 1);
  return !id.empty() &&
         std::all_of(id.begin(), id.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

ParamList MarkerSizes::fields() {
  const Allowed lengths = Range::openLow(0, 100);
  const auto check = [lengths](const Param& param) {
    for (const auto& entry : *std::get<std::map<std::string, double>*>(param.value))
      if (!namesMarker(entry.first))
        throw std::invalid_argument(param.name + ": '" + entry.first +
                                    "' is not a marker, write an id or family/id");
    lengths.check(param);
  };
  return {
      {"size", &size, lengths, "m",
       "edge length of the markers, for their poses in the camera frame; marker_locator uses those in the "
       "map"},
      {"sizes", &sizes, Allowed(lengths.text, check), "m",
       "edge lengths of individual markers, by `\"ID\"` or `\"FAMILY/ID\"`, e.g. `{\"7\": 0.1}`"},
  };
}

double MarkerSizes::of(const MarkerKey& key) const {
  if (sizes.empty()) return size;
  const std::string id = std::to_string(key.id);
  const auto full = sizes.find(key.family + "/" + id);
  if (full != sizes.end()) return full->second;
  const auto plain = sizes.find(id);
  return plain == sizes.end() ? size : plain->second;
}

std::vector<ObservedMarker> observeMarkers(const CameraModel& camera,
                                           const std::vector<Detection>& detections, const MarkerSizes& sizes,
                                           double sigma) {
  std::vector<ObservedMarker> markers;
  for (const Detection& detection : detections) {
    ObservedMarker marker{detection, sizes.of(detection.key), std::nullopt, std::nullopt};
    marker.poses = solveMarkerPose(camera, detection.corners, marker.size);
    if (marker.poses)
      marker.covariance =
          markerPoseCovariance(camera, marker.poses->best.T_camera_marker, marker.size, sigma);
    if (!marker.covariance)
      marker.poses.reset();  // consumers would take a pose without a covariance as exact
    markers.push_back(std::move(marker));
  }
  return markers;
}

}  // namespace sextant
