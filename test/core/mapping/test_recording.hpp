// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sextant/mapping/lens_correction.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/markers/marker_map.hpp"
#include "test_cameras.hpp"

namespace sextant {

/// A drive through a room, with the ground truth.
struct SimulatedRecording {
  MarkerMap truth;
  MarkerRecording recording;
  std::vector<Pose> T_map_base;
};

inline const Pose kRecordingMount = poseFromXyzRpy({0.1, 0.02, 0.9}, {-M_PI_2, 0, -M_PI_2});

inline MarkerKey key(int id) { return {"tag36h11", id}; }

/// Markers distributed over the four walls of a 5 x 5 m room, at different heights and not quite upright.
inline MarkerMap roomWithMarkers(int count) {
  MarkerMap map;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int a_wall = (count + 3) / 4;
  for (int id = 0; id < count; ++id) {
    const double side = (id / 4 + 0.5) / a_wall * 4 - 2;
    const Pose T_map_wall = poseFromXyzRpy({0, 0, 0}, {0, 0, M_PI_2 * (id % 4)});
    const Eigen::Vector3d tilt{M_PI_2 + 0.05 * uniform(random), 0.05 * uniform(random),
                               0.05 * uniform(random)};
    const Pose T_wall_marker = poseFromXyzRpy({side, 2.5, 1 + 0.5 * uniform(random)}, tilt);
    map.add({key(id), 0.2, "", T_map_wall * T_wall_marker, Matrix6d::Zero()});
  }
  return map;
}

/// The corners of a marker in an image, if it is completely inside and not too oblique.
inline std::optional<Corners> visibleCorners(const CameraModel& camera, const Pose& T_camera_marker,
                                             double size) {
  const Eigen::Vector3d centre = T_camera_marker.translation();
  if (centre.z() < 0.3 || T_camera_marker.linear().col(2).dot(centre) > -0.3 * centre.norm()) return {};
  const Eigen::AlignedBox2d inside(Eigen::Vector2d(0, 0),
                                   Eigen::Vector2d(camera.width() - 1, camera.height() - 1));
  Corners corners;
  for (int k = 0; k < 4; ++k) {
    const auto pixel = camera.project(T_camera_marker * markerCorners(size)[k]);
    if (!pixel || !inside.contains(*pixel)) return {};
    corners[k] = *pixel;
  }
  return corners;
}

/// Detections of a camera on the mount, with noise.
inline MarkerView recordedView(const MarkerMap& truth, const CameraModel& camera, const Pose& T_map_base,
                               double sigma, std::mt19937& random) {
  std::normal_distribution<double> noise(0, 1);
  MarkerView view{camera, kRecordingMount, {}};
  for (const auto& [marker_key, marker] : truth.markers()) {
    const Pose T_camera_marker = (T_map_base * kRecordingMount).inverse() * marker.T_map_marker;
    auto corners = visibleCorners(camera, T_camera_marker, marker.size);
    if (!corners) continue;
    for (auto& corner : *corners) corner += sigma * Eigen::Vector2d{noise(random), noise(random)};
    Detection detection;
    detection.key = marker_key;
    detection.corners = *corners;
    view.detections.push_back(detection);
  }
  return view;
}

/// Two rounds through the room, with all viewing directions.
inline Pose poseOnTheWay(double share) {
  const double a = 4 * M_PI * share;
  return poseFromXyzRpy({1.2 * std::cos(a), 0.9 * std::sin(a), 0}, {0, 0, 2.5 * a});
}

inline SimulatedRecording drive(const MarkerMap& truth, int instants, double sigma, int seed) {
  const CameraModel camera(testCalibrations()[1], CameraModel::Image::raw);
  std::mt19937 random(seed);
  SimulatedRecording simulated{truth, {}, {}};
  for (int i = 0; i < instants; ++i) {
    simulated.T_map_base.push_back(poseOnTheWay(static_cast<double>(i) / instants));
    simulated.recording.push_back(
        {{recordedView(truth, camera, simulated.T_map_base.back(), sigma, random)}, {}, 0});
  }
  return simulated;
}

/// Corner errors that change slowly from image to image, as those by light and blur: added to the corners, a
/// first-order autoregressive process of this standard deviation (pixels) for each marker.
inline void addSlowErrors(MarkerRecording& recording, double sigma, double correlation, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, sigma);
  std::map<MarkerKey, Eigen::Matrix<double, 8, 1>> errors;
  const auto next = [&](double& error, double weight) {
    error = weight * error + std::sqrt(1 - weight * weight) * noise(random);
  };
  for (RecordedInstant& instant : recording)
    for (MarkerView& view : instant.views)
      for (Detection& detection : view.detections) {
        const auto [error, first] = errors.emplace(detection.key, Eigen::Matrix<double, 8, 1>::Zero());
        for (int i = 0; i < 8; ++i) next(error->second[i], first ? 0 : correlation);
        for (int k = 0; k < 4; ++k) detection.corners[k] += error->second.segment<2>(2 * k);
      }
}

/// The corners that a camera with this error of its calibration sees.
inline void addLensError(MarkerRecording& recording, const LensCorrection& lens) {
  for (RecordedInstant& instant : recording)
    for (MarkerView& view : instant.views)
      for (Detection& detection : view.detections)
        for (auto& corner : detection.corners) corner += lensModes(view.camera, corner) * lens;
}

/// Some markers of a map.
inline MarkerMap only(const MarkerMap& map, const std::vector<int>& ids,
                      const Matrix6d& covariance = Matrix6d::Zero()) {
  MarkerMap some;
  for (const int id : ids) {
    MappedMarker marker = *map.find(key(id));
    marker.covariance = covariance;
    some.add(marker);
  }
  return some;
}

inline Matrix6d tapeCovariance(double metres, double radians) {
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(metres), Eigen::Vector3d::Constant(radians);
  return sigmas.cwiseAbs2().asDiagonal();
}

}  // namespace sextant
