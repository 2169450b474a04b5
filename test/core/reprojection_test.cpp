// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/reprojection.hpp"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>

#include "test_cameras.hpp"

namespace sextant {
namespace {

const Pose kMount = poseFromXyzRpy({0.1, 0.02, 0.9}, {-M_PI_2, 0.1, -M_PI_2});
const Pose kTruth = poseFromXyzRpy({1, -2, 0.1}, {0.05, -0.03, 0.8});

// Points all around the line of sight, seen with this noise.
std::vector<Sighting> sightings(const CameraModel& camera, double sigma, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> side(-0.5, 0.5), depth(1, 5);
  std::normal_distribution<double> noise(0, 1);
  std::vector<Sighting> all;
  for (int i = 0; i < 16; ++i) {
    const Eigen::Vector3d p_camera = depth(random) * Eigen::Vector3d(side(random), 0.7 * side(random), 1);
    const Eigen::Vector2d pixel =
        *camera.project(p_camera) + sigma * Eigen::Vector2d(noise(random), noise(random));
    all.push_back({&camera, kMount.inverse(), kTruth * kMount * p_camera, pixel});
  }
  return all;
}

Pose poseByOpenCV(const CameraCalibration& calibration, const std::vector<Sighting>& all) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const Sighting& sighting : all) {
    points.emplace_back(sighting.p_map.x(), sighting.p_map.y(), sighting.p_map.z());
    pixels.emplace_back(sighting.pixel.x(), sighting.pixel.y());
  }
  const auto& K = calibration.K;
  const cv::Matx33d matrix(K(0, 0), 0, K(0, 2), 0, K(1, 1), K(1, 2), 0, 0, 1);
  cv::Vec3d rotation, translation;
  cv::solvePnP(points, pixels, matrix, calibration.D, rotation, translation, false, cv::SOLVEPNP_ITERATIVE);
  cv::solvePnPRefineLM(points, pixels, matrix, calibration.D, rotation, translation,
                       cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 200, 1e-14));
  Pose T_camera_map = Pose::Identity();
  T_camera_map.linear() = expSO3({rotation[0], rotation[1], rotation[2]});
  T_camera_map.translation() = Eigen::Vector3d(translation[0], translation[1], translation[2]);
  return T_camera_map.inverse() * kMount.inverse();
}

TEST(Reprojection, FindsTheMinimumThatOpenCVFinds) {
  for (const auto& calibration : testCalibrations()) {
    if (calibration.distortion_model == "equidistant") continue;  // solvePnP has no fisheye
    const CameraModel camera(calibration, CameraModel::Image::raw);
    const auto all = sightings(camera, 0.5, 11);
    const Pose start = perturbed(kTruth, (Vector6d() << 0.3, -0.2, 0.1, 0.1, -0.1, 0.2).finished());
    const auto fit = minimizeReprojection(all, start, {});
    ASSERT_TRUE(fit);
    EXPECT_LT(poseError(poseByOpenCV(calibration, all), fit->T_map_base).norm(), 1e-5);
  }
}

TEST(Reprojection, InformationIsTheCurvatureOfTheCost) {
  const CameraModel camera(testCalibrations()[5], CameraModel::Image::raw);
  const auto all = sightings(camera, 0.0, 12);
  const ReprojectionParams params{0.4, 1e9};
  const auto fit = minimizeReprojection(all, kTruth, params);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->rms, 0.0, 1e-9);
  const double h = 1e-4;
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = h * Vector6d::Unit(i);
    const double curvature = (reprojectionCost(all, perturbed(fit->T_map_base, step), params) +
                              reprojectionCost(all, perturbed(fit->T_map_base, -step), params)) /
                             (2 * h * h);
    EXPECT_NEAR(curvature / fit->information(i, i), 1.0, 1e-3) << i;
  }
}

TEST(Reprojection, RobustLossKeepsOutliersFromPulling) {
  const CameraModel camera(testCalibrations()[1], CameraModel::Image::raw);
  auto all = sightings(camera, 0.1, 13);
  all[3].pixel += Eigen::Vector2d(40, -30);
  const auto plain = minimizeReprojection(all, kTruth, {0.1, 1e9});
  const auto robust = minimizeReprojection(all, kTruth, {0.1, 2.0});
  ASSERT_TRUE(plain && robust);
  const double plain_error = poseError(kTruth, plain->T_map_base).head<3>().norm();
  EXPECT_LT(poseError(kTruth, robust->T_map_base).head<3>().norm(), 0.1 * plain_error);
}

TEST(Reprojection, TellsNothingWhereThePoseIsFree) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  auto all = sightings(camera, 0.0, 14);
  all.resize(2);  // four numbers for six unknowns
  EXPECT_FALSE(minimizeReprojection(all, kTruth, {}));
  EXPECT_FALSE(minimizeReprojection({}, kTruth, {}));
}

}  // namespace
}  // namespace sextant
