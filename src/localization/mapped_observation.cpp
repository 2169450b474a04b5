// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/mapped_observation.hpp"

#include <algorithm>

namespace sextant {

bool isRepeated(const MarkerView& view, const MarkerKey& key) {
  return std::count_if(view.detections.begin(), view.detections.end(),
                       [&](const Detection& other) { return other.key == key; }) > 1;
}

MarkerObservation mappedObservation(const MarkerView& view, const Detection& detection,
                                    const MappedMarker& marker, double corner_sigma) {
  return {&view.camera,        view.T_base_camera.inverse(),
          marker.T_map_marker, marker.size,
          detection.corners,   cornerSigmas(view, detection, corner_sigma),
          marker.covariance};
}

void addInitialPoses(const MarkerView& view, const MappedMarker& marker, const PlanarPoses& poses,
                     size_t observation, std::vector<InitialPose>& initial_poses) {
  const auto base_pose = [&](const MarkerPose& solution) {
    return marker.T_map_marker * solution.T_camera_marker.inverse() * view.T_base_camera.inverse();
  };
  initial_poses.push_back({base_pose(poses.best), observation});
  if (poses.alternative) initial_poses.push_back({base_pose(*poses.alternative), observation});
}

}  // namespace sextant
