// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/camera_errors.hpp"

namespace sextant {
Eigen::Matrix<double, CameraErrors::kCount, 1> CameraErrors::vector() const {
  Eigen::Matrix<double, kCount, 1> values;
  values << focal_length, centre, distortion, readout_time;
  return values;
}

CameraErrors CameraErrors::fromVector(const Eigen::Matrix<double, kCount, 1>& values) {
  return {values[0], values.segment<2>(1), values[3], values[4]};
}

Eigen::Matrix<double, 2, CameraErrors::kCount> cameraErrorJacobian(const CameraModel& camera,
                                                                   const Eigen::Vector2d& pixel) {
  Eigen::Matrix<double, 2, CameraErrors::kCount> J;
  J << pixel - camera.principalPoint(), Eigen::Matrix2d::Identity(),
      camera.derivativeByFirstCoefficient(pixel), Eigen::Vector2d::Zero();
  return J;
}

double rowTime(const CameraModel& camera, double row) { return (row + 0.5) / camera.height() - 0.5; }

CameraModel withErrors(const CameraModel& camera, const CameraErrors& errors) {
  return camera.changed(1 + errors.focal_length, errors.centre, errors.distortion);
}

}  // namespace sextant
