// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/markers/marker_conversions.hpp"

#include <algorithm>
#include <stdexcept>

#include "sextant/markers/marker_family.hpp"

namespace sextant {

Marker toMsg(const Detection& detection, double size, const std::optional<PlanarPoses>& poses,
             const std::optional<Matrix6d>& covariance) {
  Marker msg;
  msg.family = detection.key.family;
  msg.id = detection.key.id;
  for (int i = 0; i < 8; ++i) msg.corners[i] = detection.corners[i / 2][i % 2];
  std::copy(detection.corner_sigmas.begin(), detection.corner_sigmas.end(), msg.corner_sigmas.begin());
  msg.hamming = detection.hamming;
  msg.decision_margin = detection.decision_margin;
  msg.alternative_reprojection_error = -1;
  if (!poses) return msg;
  msg.size = size;
  msg.pose = toPoseWithCovarianceMsg(poses->best.T_camera_marker, covariance.value_or(Matrix6d::Zero()));
  msg.reprojection_error = poses->best.reprojection_error;
  if (!poses->alternative) return msg;
  msg.alternative_pose = toPoseMsg(poses->alternative->T_camera_marker);
  msg.alternative_reprojection_error = poses->alternative->reprojection_error;
  return msg;
}

Detection fromMsg(const Marker& msg) {
  Detection detection;
  detection.key = {canonicalFamily(msg.family), msg.id};
  for (int i = 0; i < 8; ++i) detection.corners[i / 2][i % 2] = msg.corners[i];
  for (const auto& corner : detection.corners)
    if (!corner.allFinite())
      throw std::invalid_argument("marker " + std::to_string(msg.id) + ": a corner is not finite");
  // Zero is the default of the message field and means unknown.
  for (int i = 0; i < 4; ++i)
    detection.corner_sigmas[i] = msg.corner_sigmas[i] > 0 ? msg.corner_sigmas[i] : -1;
  detection.hamming = msg.hamming;
  detection.decision_margin = msg.decision_margin;
  return detection;
}

MarkerMapEntry toMsg(const MappedMarker& marker) {
  MarkerMapEntry msg;
  msg.family = marker.key.family;
  msg.id = marker.key.id;
  msg.size = marker.size;
  msg.name = marker.name;
  msg.pose = toPoseWithCovarianceMsg(marker.T_map_marker, marker.covariance);
  return msg;
}

MarkerMap fromMsg(const MarkerMapEntries& msg) {
  if (msg.header.frame_id.empty()) throw std::invalid_argument("the map's header has no frame_id");
  MarkerMap map(msg.header.frame_id);
  for (const MarkerMapEntry& entry : msg.markers)
    map.add({{entry.family, entry.id},
             entry.size,
             entry.name,
             fromMsg(entry.pose.pose),
             fromMsg(entry.pose.covariance)});
  return map;
}

}  // namespace sextant
