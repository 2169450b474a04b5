// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/camera_errors.hpp"

#include <gtest/gtest.h>

#include "test_cameras.hpp"

namespace sextant {
namespace {

TEST(CameraErrors, GiveTheCameraWithTheOtherCalibration) {
  CameraCalibration calibration = testCalibrations()[1];
  const CameraModel camera(calibration, CameraModel::Image::raw);
  calibration.K(0, 0) *= 1.01;
  calibration.K(1, 1) *= 1.01;
  calibration.K(0, 2) += 3;
  calibration.K(1, 2) -= 2;
  calibration.D[0] += 0.05;
  const CameraModel other(calibration, CameraModel::Image::raw);
  const CameraModel changed = withErrors(camera, {0.01, {3, -2}, 0.05, 0.02});
  for (const double x : {-0.4, 0.1, 0.5}) {
    const Eigen::Vector3d point(x, 0.3 - x, 1.2);
    EXPECT_LT((*changed.project(point) - *other.project(point)).norm(), 1e-9);
  }
}

TEST(CameraErrors, JacobianIsTheNumericOne) {
  constexpr double kStep = 1e-6;
  for (const CameraCalibration& calibration : testCalibrations()) {
    const CameraModel camera(calibration, CameraModel::Image::raw);
    const Eigen::Vector3d point(0.31, -0.17, 1.1);
    const auto J = cameraErrorJacobian(camera, *camera.project(point));
    for (int i = 0; i < CameraErrors::kCount; ++i) {
      const CameraErrors step =
          CameraErrors::fromVector(kStep * Eigen::Matrix<double, CameraErrors::kCount, 1>::Unit(i));
      const Eigen::Vector2d numeric =
          (*withErrors(camera, step).project(point) - *camera.project(point)) / kStep;
      EXPECT_LT((J.col(i) - numeric).norm(), 1e-3 * (1 + numeric.norm()))
          << calibration.distortion_model << i;
    }
  }
}

}  // namespace
}  // namespace sextant
