// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "test_cameras.hpp"

namespace sextant {
namespace {

constexpr double kSize = 0.2;

// A marker that faces the camera (its z toward it), turned by these angles, at this place in the optical
// frame.
Pose facing(const Eigen::Vector3d& place, double tilt, double pan, double spin) {
  return poseFromXyzRpy(place, {0, 0, 0}) * poseFromXyzRpy({0, 0, 0}, {M_PI, 0, 0}) *
         poseFromXyzRpy({0, 0, 0}, {tilt, pan, spin});
}

Corners projected(const CameraModel& camera, const Pose& T_camera_marker, double size = kSize) {
  Corners corners;
  for (int i = 0; i < 4; ++i) corners[i] = *camera.project(T_camera_marker * markerCorners(size)[i]);
  return corners;
}

TEST(MarkerPose, ExactCornersGiveTheExactPose) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> angle(-0.9, 0.9), place(-0.25, 0.25), depth(0.5, 4);
  for (const auto& calibration : testCalibrations()) {
    for (const auto image : {CameraModel::Image::raw, CameraModel::Image::rectified}) {
      const CameraModel camera(calibration, image);
      for (int i = 0; i < 50; ++i) {
        const double z = depth(random);
        const double tilt = angle(random), pan = angle(random), spin = 3 * angle(random);
        const Pose truth = facing({z * place(random), z * place(random), z}, tilt, pan, spin);
        const auto poses = solveMarkerPose(camera, projected(camera, truth), kSize);
        ASSERT_TRUE(poses);
        EXPECT_LT(poseError(truth, poses->best.T_camera_marker).norm(), 1e-5 * z)
            << calibration.distortion_model;
        EXPECT_LT(poses->best.reprojection_error, 1e-6);
      }
    }
  }
}

TEST(MarkerPose, FarMarkerHasTwoPosesThatFit) {
  // At 4 m a tilt of +0.3 and of -0.3 rad look nearly the same: the two solutions are mirrored.
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const Pose truth = facing({0, 0, 4}, 0.3, 0, 0);
  const auto poses = solveMarkerPose(camera, projected(camera, truth), kSize);
  ASSERT_TRUE(poses && poses->alternative);
  const Pose other = poses->alternative->T_camera_marker;
  EXPECT_LT(poses->alternative->reprojection_error, 0.15);
  EXPECT_LT(poseError(facing({0, 0, 4}, -0.3, 0, 0), other).tail<3>().norm(), 0.05);
  EXPECT_LT(poses->ambiguity(), 0.01);
}

TEST(MarkerPose, CovarianceIsThatOfManyNoisyTries) {
  const CameraModel camera(testCalibrations()[1], CameraModel::Image::raw);
  const Pose truth = facing({0.3, -0.2, 1.0}, 0.5, 0.4, 0.1);
  const double sigma = 0.2;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, sigma);
  const Corners exact = projected(camera, truth);
  const auto covariance = markerPoseCovariance(camera, truth, kSize, sigma);
  ASSERT_TRUE(covariance);
  const int n = 2000;
  double nees = 0;
  for (int i = 0; i < n; ++i) {
    Corners corners = exact;
    for (auto& corner : corners) corner += Eigen::Vector2d{noise(random), noise(random)};
    const auto poses = solveMarkerPose(camera, corners, kSize);
    ASSERT_TRUE(poses);
    const Vector6d error = poseError(truth, poses->best.T_camera_marker);
    nees += error.dot(covariance->inverse() * error) / n;
  }
  EXPECT_NEAR(nees, 6.0, 0.3);  // chi-square with 6 degrees of freedom; sqrt(12 / 2000) = 0.08
}

TEST(MarkerPose, RefusesWhatIsNoMarker) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const Corners good = projected(camera, facing({0, 0, 1}, 0.2, 0.1, 0));
  EXPECT_TRUE(solveMarkerPose(camera, good, kSize));
  EXPECT_FALSE(solveMarkerPose(camera, good, 0.0));
  EXPECT_FALSE(solveMarkerPose(camera, {good[0], good[0], good[0], good[0]}, kSize));
  EXPECT_FALSE(solveMarkerPose(camera, {good[1], good[0], good[3], good[2]}, kSize));  // mirrored
  EXPECT_FALSE(solveMarkerPose(camera, {good[0], good[2], good[1], good[3]}, kSize));  // crossed
  Corners nan = good;
  nan[2].x() = std::nan("");
  EXPECT_FALSE(solveMarkerPose(camera, nan, kSize));
}

}  // namespace
}  // namespace sextant
