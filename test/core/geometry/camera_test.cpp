// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/camera.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <random>

#include "test_cameras.hpp"

namespace sextant {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

CameraModel raw(const CameraCalibration& calibration) { return {calibration, CameraModel::Image::raw}; }

cv::Point2d projectByOpenCV(const CameraCalibration& calibration, const Eigen::Vector3d& p) {
  const auto& K = calibration.K;
  const cv::Matx33d matrix(K(0, 0), 0, K(0, 2), 0, K(1, 1), K(1, 2), 0, 0, 1);
  const std::vector<cv::Point3d> points = {{p.x(), p.y(), p.z()}};
  const cv::Vec3d zero(0, 0, 0);
  std::vector<cv::Point2d> pixels;
  if (calibration.distortion_model == "equidistant")
    cv::fisheye::projectPoints(points, pixels, zero, zero, matrix, calibration.D);
  else
    cv::projectPoints(points, zero, zero, matrix, calibration.D, pixels);
  return pixels[0];
}

std::vector<Eigen::Vector3d> pointsInView() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> side(-0.7, 0.7), depth(0.3, 8);
  std::vector<Eigen::Vector3d> points = {{0, 0, 2}};
  for (int i = 0; i < 200; ++i) {
    const double z = depth(random);
    points.push_back(z * Eigen::Vector3d{side(random), 0.8 * side(random), 1});
  }
  return points;
}

TEST(Camera, ProjectsAsOpenCV) {
  for (const auto& calibration : testCalibrations()) {
    const CameraModel camera = raw(calibration);
    for (const auto& p : pointsInView()) {
      const auto pixel = camera.project(p);
      ASSERT_TRUE(pixel) << calibration.distortion_model << " " << p.transpose();
      const cv::Point2d expected = projectByOpenCV(calibration, p);
      EXPECT_NEAR(pixel->x(), expected.x, 1e-8);
      EXPECT_NEAR(pixel->y(), expected.y, 1e-8);
    }
  }
}

TEST(Camera, UnprojectIsTheInverse) {
  for (const auto& calibration : testCalibrations()) {
    const CameraModel camera = raw(calibration);
    for (const auto& p : pointsInView()) {
      const auto ray = camera.unproject(*camera.project(p));
      ASSERT_TRUE(ray);
      EXPECT_LT((*ray - p.normalized()).norm(), 1e-9) << calibration.distortion_model;
    }
  }
}

TEST(Camera, JacobianIsTheDifferenceQuotient) {
  const double h = 1e-6;
  for (const auto& calibration : testCalibrations()) {
    const CameraModel camera = raw(calibration);
    for (const auto& p : pointsInView()) {
      const auto projection = camera.projectWithJacobian(p);
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector2d quotient = (*camera.project(p + step) - *camera.project(p - step)) / (2 * h);
        EXPECT_LT((projection->jacobian.col(axis) - quotient).norm(), 1e-5 * (1 + quotient.norm()));
      }
    }
  }
}

TEST(Camera, RectifiedImageLooksFromTheRawFrame) {
  // The rectified camera is turned by R: a point of the raw frame lies at P [R p].
  CameraCalibration calibration = testCalibrations()[1];
  calibration.R = Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const CameraModel camera(calibration, CameraModel::Image::rectified);
  const Eigen::Vector3d p(0.2, -0.1, 1.5), expected = calibration.P.leftCols<3>() * calibration.R * p;
  EXPECT_LT((*camera.project(p) - expected.hnormalized()).norm(), 1e-9);
  EXPECT_LT((*camera.unproject(*camera.project(p)) - p.normalized()).norm(), 1e-9);
}

TEST(Camera, SeesNothingBehindItOrBeyondItsLens) {
  for (const auto& calibration : testCalibrations()) EXPECT_FALSE(raw(calibration).project({0, 0, -1}));
  // r - 0.3 r^3 turns back at r = 1 / sqrt(0.9): what lies beyond must not fold back into the image.
  const CameraModel barrel = raw(testCalibration("plumb_bob", {-0.3, 0, 0, 0}));
  EXPECT_TRUE(barrel.project({1.04, 0, 1}));
  EXPECT_FALSE(barrel.project({1.07, 0, 1}));
  EXPECT_FALSE(barrel.unproject({325 + 400 * 0.8, 236}));
  // The field of view of a fisheye lens includes points beside and behind the camera.
  EXPECT_TRUE(raw(testCalibration("equidistant", {0, 0, 0, 0})).project({1, 0, -0.2}));
}

void expectRefused(CameraCalibration calibration, const std::string& part,
                   CameraModel::Image image = CameraModel::Image::raw) {
  try {
    CameraModel(calibration, image);
    FAIL() << "accepted, but " << part;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Camera, RefusesWhatIsNoCalibration) {
  const CameraCalibration good = testCalibrations()[1];
  const auto with = [&](auto change) {
    CameraCalibration bad = good;
    change(bad);
    return bad;
  };
  expectRefused(with([](auto& c) { c.K.setZero(); }), "K fx is 0");
  expectRefused(with([](auto& c) { c.K(1, 1) = kNan; }), "finite");
  expectRefused(with([](auto& c) { c.K(0, 0) = c.K(1, 1) = 1; }), "calibrate the camera");
  expectRefused(with([](auto& c) { c.K(0, 2) = 1e5; }), "cx");
  expectRefused(with([](auto& c) { c.width = 0; }), "image size");
  expectRefused(with([](auto& c) { c.distortion_model = "fov"; }), "distortion_model is 'fov'");
  expectRefused(with([](auto& c) { c.D.resize(3); }), "D has 3 numbers");
  expectRefused(with([](auto& c) { c.D[2] = kNan; }), "D[2]");
  expectRefused(testCalibration("equidistant", {}), "D has 0 numbers");
  expectRefused(with([](auto& c) { c.P.setZero(); }), "P fx is 0", CameraModel::Image::rectified);
  expectRefused(with([](auto& c) { c.R.setZero(); }), "R is not a rotation", CameraModel::Image::rectified);
}

}  // namespace
}  // namespace sextant
