// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/mapped_observation.hpp"

#include <gtest/gtest.h>

#include "test_cameras.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

TEST(MappedObservation, FollowsTheFramesFromTheMapToThePixels) {
  MarkerMap map = room();
  MappedMarker marker = *map.find({kFamily, 1});
  marker.covariance = 1e-4 * Matrix6d::Identity();
  const MarkerView view =
      look(map, CameraModel(testCalibrations()[1], CameraModel::Image::raw), kTruth, 0, 1);
  const MarkerObservation observation = mappedObservation(view, view.detections[1], marker, 0.3);
  EXPECT_EQ(observation.camera, &view.camera);
  EXPECT_EQ(observation.map_covariance, marker.covariance);
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d p_map = observation.T_map_marker * markerCorners(observation.size)[k];
    const auto pixel = view.camera.project(observation.T_camera_base * kTruth.inverse() * p_map);
    EXPECT_LT((*pixel - observation.corners[k]).norm(), 1e-9);
    EXPECT_DOUBLE_EQ(observation.sigmas[k], 0.3);
  }
}

TEST(MappedObservation, AnInitialPoseIsTheBasesPose) {
  const MarkerMap map = room();
  const MarkerView view =
      look(map, CameraModel(testCalibrations()[0], CameraModel::Image::raw), kTruth, 0, 1);
  const auto poses = solveMarkerPose(view.camera, view.detections[3].corners, 0.3);
  std::vector<InitialPose> initial_poses;
  addInitialPoses(view, *map.find({kFamily, 3}), *poses, 7, initial_poses);
  ASSERT_EQ(initial_poses.size(), poses->alternative ? 2u : 1u);
  EXPECT_LT(poseError(kTruth, initial_poses[0].T_map_base).norm(), 1e-6);
  for (const InitialPose& initial : initial_poses) EXPECT_EQ(initial.observation, 7u);
}

TEST(MappedObservation, AMarkerIsRepeatedByItsFamilyAndId) {
  MarkerView view = look(room(), CameraModel(testCalibrations()[0], CameraModel::Image::raw), kTruth, 0, 1);
  view.detections[0].key.family = "tag16h5";
  view.detections[1].key.id = 0;
  view.detections[3].key.id = 2;
  EXPECT_FALSE(isRepeated(view, {kFamily, 0}));
  EXPECT_FALSE(isRepeated(view, {"tag16h5", 0}));
  EXPECT_TRUE(isRepeated(view, {kFamily, 2}));
}

}  // namespace
}  // namespace sextant
