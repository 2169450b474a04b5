// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <vector>

#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// A marker frame on the wall x = const of a room, facing a robot that faces +x.
inline Pose markerOnWall(const Eigen::Vector3d& position, double yaw = 0) {
  Pose pose = poseFromXyzRpy({0, 0, 0}, {0, 0, yaw}) * poseFromXyzRpy({0, 0, 0}, {M_PI_2, 0, -M_PI_2});
  pose.translation() = position;
  return pose;
}

/// Mount of a camera that faces forward, at this height above the base.
inline Pose forwardMount(double height) { return poseFromXyzRpy({0.1, 0.02, height}, {-M_PI_2, 0, -M_PI_2}); }

/// The observations of markers from a base pose, with noise of sigma pixels.
inline std::vector<MarkerObservation> seenFrom(const Pose& T_map_base, const CameraModel& camera,
                                               const Pose& mount, const std::vector<Pose>& markers,
                                               double size, double sigma, std::mt19937& random) {
  std::normal_distribution<double> noise(0, 1);
  std::vector<MarkerObservation> all;
  for (const Pose& T_map_marker : markers) {
    MarkerObservation observation{&camera, mount.inverse(), T_map_marker, size, {}, {}, Matrix6d::Zero()};
    const Pose T_camera_marker = (T_map_base * mount).inverse() * T_map_marker;
    for (int k = 0; k < 4; ++k)
      observation.corners[k] = *camera.project(T_camera_marker * markerCorners(size)[k]) +
                               sigma * Eigen::Vector2d{noise(random), noise(random)};
    observation.sigmas.fill(sigma > 0 ? sigma : 0.3);
    all.push_back(observation);
  }
  return all;
}

}  // namespace sextant
