// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/pose_hypotheses.hpp"

#include <gtest/gtest.h>

#include <random>

#include "sextant/markers/marker_pose.hpp"
#include "test_cameras.hpp"
#include "test_observations.hpp"

namespace sextant {
namespace {

const Pose kForwardMount = forwardMount(1.0);

std::vector<InitialPose> initialPoses(const std::vector<MarkerObservation>& observations) {
  std::vector<InitialPose> all;
  for (size_t i = 0; i < observations.size(); ++i) {
    const MarkerObservation& observation = observations[i];
    const auto poses = solveMarkerPose(*observation.camera, observation.corners, observation.size);
    const auto base = [&](const MarkerPose& pose) {
      return observation.T_map_marker * pose.T_camera_marker.inverse() * observation.T_camera_base;
    };
    all.push_back({base(poses->best), i});
    if (poses->alternative) all.push_back({base(*poses->alternative), i});
  }
  return all;
}

class PoseHypotheses : public testing::Test {
 protected:
  std::vector<PoseHypothesis> find(const std::vector<MarkerObservation>& observations,
                                   const std::optional<PosePrior>& prior = std::nullopt) {
    return poseHypotheses(observations, initialPoses(observations), {}, prior);
  }

  CameraModel camera_{testCalibrations()[0], CameraModel::Image::raw};
  std::mt19937 random_{3};
};

// 4 m off and 25 degrees from head-on, a square of 0.2 m has its mirrored pose at almost the same cost.
TEST_F(PoseHypotheses, KeepsBothPosesOfOneFarMarker) {
  const Pose truth = poseFromXyzRpy({-0.6, 1.7, 0}, {0, 0, -0.44});
  const auto found =
      find(seenFrom(truth, camera_, kForwardMount, {markerOnWall({3, 0, 1})}, 0.2, 0.3, random_));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].weight + found[1].weight, 1.0, 1e-12);
  EXPECT_GT(found[1].weight, 1e-3);
  EXPECT_GT((found[0].T_map_base.translation() - found[1].T_map_base.translation()).norm(), 1.0);
}

TEST_F(PoseHypotheses, ThePriorDecidesAndIsNotMixedIn) {
  const Pose truth = poseFromXyzRpy({-0.6, 1.7, 0}, {0, 0, -0.44});
  const auto observations =
      seenFrom(truth, camera_, kForwardMount, {markerOnWall({3, 0, 1})}, 0.2, 0.3, random_);
  const auto open = find(observations);
  for (const PoseHypothesis& meant : open) {
    const PosePrior prior{perturbed(meant.T_map_base, Vector6d::Constant(0.02)), 0.01 * Matrix6d::Identity()};
    const auto found = find(observations, prior);
    EXPECT_GT(found[0].weight, 0.9999);
    EXPECT_LT(poseError(meant.T_map_base, found[0].T_map_base).norm(), 1e-9);
    EXPECT_LT((found[0].covariance - meant.covariance).norm(), 1e-9);
  }
}

TEST_F(PoseHypotheses, LeavesOutAMarkerThatWasMoved) {
  const std::vector<Pose> markers = {markerOnWall({3, 0.8, 1}), markerOnWall({3, 0, 1.2}),
                                     markerOnWall({3, -0.8, 1}), markerOnWall({2, 1.4, 1}, -0.8)};
  const Pose truth = poseFromXyzRpy({0.5, 0.1, 0}, {0, 0, 0.1});
  auto observations = seenFrom(truth, camera_, kForwardMount, markers, 0.2, 0.2, random_);
  observations[1].T_map_marker.translation() += Eigen::Vector3d(0, 0.2, 0);  // where the map has it
  const auto found = find(observations);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].used, (std::vector<size_t>{0, 2, 3}));
  EXPECT_GT(found[0].weight, 0.9999);
  EXPECT_LT((found[0].T_map_base.translation() - truth.translation()).norm(), 0.02);
}

TEST_F(PoseHypotheses, TwoThatContradictEachOtherLeaveBothOpen) {
  const Pose truth = poseFromXyzRpy({0.5, 0.1, 0}, {0, 0, 0.1});
  auto observations =
      seenFrom(truth, camera_, kForwardMount,
               {markerOnWall({3, 0.8, 1}, -0.6), markerOnWall({3, -0.8, 1}, 0.6)}, 0.3, 0.1, random_);
  observations[0].T_map_marker.translation() += Eigen::Vector3d(0, 0, 0.5);
  const auto found = find(observations);
  ASSERT_GE(found.size(), 2u);
  EXPECT_EQ(found[0].used.size(), 1u);
  EXPECT_LT(found[0].weight, 0.9999);
}

TEST_F(PoseHypotheses, NothingToStartFromIsNothing) {
  EXPECT_TRUE(poseHypotheses({}, {}, {}, std::nullopt).empty());
}

}  // namespace
}  // namespace sextant
