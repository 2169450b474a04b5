// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tilt_grid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "sextant/markers/marker_pose.hpp"
#include "test_cameras.hpp"
#include "test_observations.hpp"

namespace sextant {
namespace {

struct SeenWall {
  SeenWall(const Pose& T_map_base, const std::vector<Pose>& markers)
      : camera(testCalibrations()[1], CameraModel::Image::raw) {
    std::mt19937 random(3);
    const Pose mount = forwardMount(1.0);
    observations = seenFrom(T_map_base, camera, mount, markers, 0.2, 0, random);
    std::vector<InitialPose> initial_poses = {{T_map_base, 0}};
    const auto poses = solveMarkerPose(camera, observations[0].corners, 0.2);
    if (poses && poses->alternative)
      initial_poses.push_back(
          {markers[0] * poses->alternative->T_camera_marker.inverse() * mount.inverse(), 0});
    minima = poseHypotheses(observations, initial_poses, {}, std::nullopt);
  }
  TiltGrid grid() const { return tiltGrid(observations, minima, std::nullopt); }

  CameraModel camera;
  std::vector<MarkerObservation> observations;
  std::vector<PoseHypothesis> minima;
};

const std::vector<Pose> kCorner = {markerOnWall({2, 0.4, 1}, 0.3), markerOnWall({2.5, -0.6, 1.2}),
                                   markerOnWall({1.8, 0, 0.9}, -0.5)};

// For markers with a Gaussian posterior, the grid has the moments of that Gaussian.
TEST(TiltGrid, IsTheGaussianWhereThereIsOne) {
  const SeenWall seen(Pose::Identity(), kCorner);
  ASSERT_EQ(seen.minima.size(), 1u);
  const TiltGrid grid = seen.grid();
  EXPECT_EQ(grid.group, std::vector<size_t>{0});
  double sum = 0, most = -1e9;
  for (const TiltCell& cell : grid.cells) most = std::max(most, cell.log_density);
  Matrix6d moment = Matrix6d::Zero();
  for (const TiltCell& cell : grid.cells) {
    const double weight = std::exp(cell.log_density - most);
    const Vector6d e = poseError(cell.T_map_base, seen.minima[0].T_map_base);
    moment += weight * (e * e.transpose() + cell.covariance);
    sum += weight;
    EXPECT_LT(cell.cost - seen.minima[0].cost, 21);
  }
  const Matrix6d P = seen.minima[0].covariance, L = P.llt().matrixL();
  const Matrix6d inverse = L.inverse();
  EXPECT_LT((inverse * (moment / sum) * inverse.transpose() - Matrix6d::Identity()).norm(), 0.02);
}

// For the two planar solutions of one marker at 5 m. The camera is rolled: for an upright square on the
// optical axis, rounding decides whether OpenCV finds both.
TEST(TiltGrid, OnlyABarrierPartsTwoMinima) {
  const auto groupsFrom = [](double yaw) {
    const Pose T_map_base = poseFromXyzRpy({3 - 5 * std::cos(yaw), -5 * std::sin(yaw), 0}, {0.1, 0, yaw});
    const SeenWall seen(T_map_base, {markerOnWall({3, 0, 1})});
    EXPECT_EQ(seen.minima.size(), 2u);
    return seen.grid().group;
  };
  const auto oblique = groupsFrom(1), head_on = groupsFrom(0.2);
  EXPECT_NE(oblique.at(0), oblique.at(1));
  EXPECT_EQ(head_on.at(0), head_on.at(1));
}

}  // namespace
}  // namespace sextant
