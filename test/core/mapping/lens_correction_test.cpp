// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/lens_correction.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <functional>

#include "test_cameras.hpp"

namespace sextant {
namespace {

CameraCalibration pinhole() {
  CameraCalibration calibration;
  calibration.width = 640;
  calibration.height = 480;
  calibration.distortion_model = "plumb_bob";
  calibration.D = {0, 0, 0, 0, 0};
  calibration.K << 320, 0, 319.5, 0, 320, 239.5, 0, 0, 1;
  return calibration;
}

// Displacements of pixels all over the image by a change of the calibration, against those by the modes that
// fit best. Returns the root mean square of both.
std::pair<double, double> displacements(const std::function<void(CameraCalibration&)>& change) {
  CameraCalibration changed = pinhole();
  change(changed);
  const CameraModel camera(pinhole(), CameraModel::Image::raw), other(changed, CameraModel::Image::raw);
  Eigen::MatrixXd modes(2 * 16 * 12, kLensModes);
  Eigen::VectorXd displaced(modes.rows());
  for (int i = 0; i < 16 * 12; ++i) {
    const Eigen::Vector2d pixel(20 + 40 * (i % 16), 20 + 40 * (i / 16));
    displaced.segment<2>(2 * i) = *other.project(*camera.unproject(pixel)) - pixel;
    modes.middleRows<2>(2 * i) = lensModes(camera, pixel);
  }
  const Eigen::VectorXd rest = displaced - modes * modes.householderQr().solve(displaced);
  return {displaced.norm() / std::sqrt(16.0 * 12), rest.norm() / std::sqrt(16.0 * 12)};
}

TEST(LensCorrection, ModesContainTheErrorsOfACalibration) {
  const std::vector<std::function<void(CameraCalibration&)>> changes = {
      [](CameraCalibration& c) { c.K(0, 0) += 1; },  [](CameraCalibration& c) { c.K(1, 1) -= 2; },
      [](CameraCalibration& c) { c.K(0, 2) += 1; },  [](CameraCalibration& c) { c.K(1, 2) -= 3; },
      [](CameraCalibration& c) { c.D[0] = 0.005; },  [](CameraCalibration& c) { c.D[1] = 0.005; },
      [](CameraCalibration& c) { c.D[2] = -0.002; }, [](CameraCalibration& c) { c.D[3] = 0.002; },
  };
  for (const auto& change : changes) {
    const auto [displaced, rest] = displacements(change);
    EXPECT_GT(displaced, 0.3);
    EXPECT_LT(rest, 0.02 * displaced);
  }
}

TEST(LensCorrection, CorrectedCornersAreThoseWithoutTheDisplacement) {
  const CameraModel camera(pinhole(), CameraModel::Image::raw);
  const Corners corners = {Eigen::Vector2d(3, 5), {600, 7}, {620, 400}, {320, 240}};
  const LensCorrection lens = LensCorrection::LinSpaced(-2, 2);
  const Corners corrected = correctedCorners(camera, corners, lens);
  for (int k = 0; k < 4; ++k)
    EXPECT_LT((corrected[k] + lensModes(camera, corrected[k]) * lens - corners[k]).norm(), 1e-3);
}

TEST(LensCorrection, ItsDisplacementIsThatOverTheImage) {
  const CameraModel camera(pinhole(), CameraModel::Image::raw);
  LensCorrection lens = LensCorrection::Zero();
  lens[1] = -3;  // everywhere
  EXPECT_NEAR(lensDisplacement(camera, lens), 3, 1e-12);
  lens << 0, 0, 2, 0, 0, 0, 0, 0;  // 2 x, x uniform up to 0.8
  EXPECT_NEAR(lensDisplacement(camera, lens), 1.6 / std::sqrt(3.0), 0.01);
}

}  // namespace
}  // namespace sextant
