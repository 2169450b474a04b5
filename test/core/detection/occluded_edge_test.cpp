// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "occluded_edge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sextant/geometry/pose.hpp"
#include "test_cameras.hpp"

namespace sextant {
namespace {

// A square of 0.2 m before the camera, turned about its upright axis.
Corners seen(const CameraModel& camera, double yaw) {
  const Pose pose = poseFromXyzRpy({0.1, 0.05, 1.0}, {M_PI - 0.1, 0, 0}) *
                    poseFromXyzRpy(Eigen::Vector3d::Zero(), {0, yaw, 0});
  Corners corners;
  for (int i = 0; i < 4; ++i) corners[i] = *camera.project(pose * markerCorners(0.2)[i]);
  return corners;
}

EdgeCurve edge(const CameraModel& camera, const Corners& corners, int i) {
  EdgeCurve curve(corners[i], corners[(i + 1) % 4], true);
  curve.followLens(camera);
  return curve;
}

OccludedEdge occludedEdge(const CameraModel& camera, const Corners& corners, int first_corner, double sigma) {
  return {first_corner,
          edge(camera, corners, (first_corner + 3) % 4),
          edge(camera, corners, (first_corner + 1) % 4),
          sigma,
          sigma,
          {sigma, sigma, sigma, sigma}};
}

TEST(ReconstructEdge, IsExactWhereTheOthersAre) {
  for (const CameraCalibration& calibration : testCalibrations()) {
    const CameraModel camera(calibration, CameraModel::Image::raw);
    for (const double yaw : {-0.8, -0.3, 0.4, 0.7})
      for (int first_corner = 0; first_corner < 4; ++first_corner) {
        const Corners truth = seen(camera, yaw);
        Corners start = truth;
        start[first_corner] += Eigen::Vector2d(4, -3);
        start[(first_corner + 1) % 4] += Eigen::Vector2d(-2, 5);
        const auto found = reconstructEdge(camera, start, occludedEdge(camera, truth, first_corner, 0.02));
        EXPECT_TRUE(found) << calibration.distortion_model << " yaw " << yaw << " edge " << first_corner;
        for (int k = 0; found && k < 2; ++k)
          EXPECT_LT((found->corners[k] - truth[(first_corner + k) % 4]).norm(), 0.02)
              << calibration.distortion_model << " yaw " << yaw << " edge " << first_corner;
      }
  }
}

// Oblique, and head-on, where a turn that way or this moves the edge alike.
TEST(ReconstructEdge, TellsHowFarItIsOff) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  constexpr double kSigma = 0.1;
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, kSigma);
  for (const double yaw : {0.0, 0.3, 0.7}) {
    const Corners truth = seen(camera, yaw);
    double squares = 0, variance = 0;
    int count = 0;
    for (int i = 0; i < 400; ++i) {
      OccludedEdge occluded = occludedEdge(camera, truth, 1, kSigma);
      for (EdgeCurve* curve : {&occluded.before, &occluded.after}) {
        const double begin = noise(random), end = noise(random);
        curve->c[0] += 0.5 * (begin + end);
        curve->c[1] += 0.5 * (end - begin);
      }
      Corners corners = truth;
      for (const int k : {0, 3}) corners[k] += Eigen::Vector2d{noise(random), noise(random)};
      const auto found = reconstructEdge(camera, corners, occluded);
      if (!found) continue;
      ++count;
      for (int k = 0; k < 2; ++k) {
        squares += (found->corners[k] - truth[(1 + k) % 4]).squaredNorm() / 2;
        variance += found->sigmas[k] * found->sigmas[k];
      }
    }
    EXPECT_GT(count, 380) << yaw;
    EXPECT_GT(std::sqrt(variance / squares), 0.75) << yaw;
    EXPECT_LT(std::sqrt(variance / squares), yaw == 0 ? 30.0 : 2.0) << yaw;
  }
}

// Both occluded corners on one of the edges.
TEST(ReconstructEdge, SaysNothingOfWhatIsNoSquare) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const Corners truth = seen(camera, 0.4);
  OccludedEdge occluded = occludedEdge(camera, truth, 1, 0.02);
  occluded.before = occluded.after;
  EXPECT_FALSE(reconstructEdge(camera, truth, occluded));
}

}  // namespace
}  // namespace sextant
