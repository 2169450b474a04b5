// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"

namespace sextant {

/// One calibration for every distortion model and number of coefficients, 640 x 480 pixels.
inline CameraCalibration testCalibration(const std::string& model, const std::vector<double>& D) {
  CameraCalibration calibration;
  calibration.width = 640;
  calibration.height = 480;
  calibration.distortion_model = model;
  calibration.D = D;
  calibration.K << 400, 0, 325, 0, 402, 236, 0, 0, 1;
  calibration.P << 380, 0, 318, 0, 0, 380, 241, 0, 0, 0, 1, 0;
  return calibration;
}

inline std::vector<CameraCalibration> testCalibrations() {
  const std::vector<std::pair<std::string, std::vector<double>>> lenses = {
      {"plumb_bob", {}},
      {"plumb_bob", {-0.30, 0.12, 0.001, -0.002}},
      {"plumb_bob", {0.135, -0.234, 0.0007, 0.0048, 0.05}},
      {"plumb_bob", {-0.30, 0.12, 0.001, -0.002, -0.02, 0.01, 0.02, -0.01}},
      {"rational_polynomial", {2.5, 1.2, 0.0004, -0.0003, 0.05, 2.8, 1.9, 0.3}},
      {"equidistant", {-0.0177, -0.0028, 0.0070, -0.0031}}};
  std::vector<CameraCalibration> all;
  for (const auto& [model, D] : lenses) all.push_back(testCalibration(model, D));
  return all;
}

/// T_map_camera of a camera at p that faces +x, rotated by roll, pitch and yaw.
inline Pose cameraPose(const Eigen::Vector3d& p, const Eigen::Vector3d& rpy) {
  Pose T_mount_optical = Pose::Identity();
  T_mount_optical.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return poseFromXyzRpy(p, rpy) * T_mount_optical;
}

}  // namespace sextant
