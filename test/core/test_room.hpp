// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <string>

#include "sextant/localization/marker_locator.hpp"

namespace sextant {

inline const std::string kFamily = "tag36h11";

/// Three markers on the wall x = 3, facing -x, and one on the wall y = 2.
inline MarkerMap room() {
  MarkerMap map;
  const Eigen::Vector3d toward_minus_x(M_PI_2, 0, -M_PI_2), toward_minus_y(M_PI_2, 0, 0);
  for (int i = 0; i < 3; ++i)
    map.add({{kFamily, i}, 0.2, "", poseFromXyzRpy({3, 0.6 * (i - 1), 1}, toward_minus_x), Matrix6d::Zero()});
  map.add({{kFamily, 3}, 0.3, "", poseFromXyzRpy({2.2, 2, 1.2}, toward_minus_y), Matrix6d::Zero()});
  return map;
}

inline const Pose kMount = poseFromXyzRpy({0.1, 0.02, 0.9}, {-M_PI_2, 0, -M_PI_2});
inline const Pose kTruth = poseFromXyzRpy({0.7, 0.3, 0}, {0.01, -0.02, 0.35});

/// Detections of all markers by a camera on that mount from a base pose, with noise of sigma pixels.
inline MarkerView look(const MarkerMap& map, const CameraModel& camera, const Pose& T_map_base, double sigma,
                       int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  MarkerView view{camera, kMount, {}};
  for (const auto& [key, marker] : map.markers()) {
    Detection detection;
    detection.key = key;
    const Pose T_camera_marker = (T_map_base * kMount).inverse() * marker.T_map_marker;
    for (int k = 0; k < 4; ++k)
      detection.corners[k] = *camera.project(T_camera_marker * markerCorners(marker.size)[k]) +
                             sigma * Eigen::Vector2d{noise(random), noise(random)};
    view.detections.push_back(detection);
  }
  return view;
}

}  // namespace sextant
