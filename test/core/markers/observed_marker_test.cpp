// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/observed_marker.hpp"

#include <gtest/gtest.h>

#include "test_cameras.hpp"

namespace sextant {
namespace {

TEST(MarkerSizes, FamilyAndIdWinOverIdWinsOverAll) {
  MarkerSizes sizes{0.2, {{"7", 0.1}, {"tag25h9/7", 0.3}}};
  validate(sizes);
  EXPECT_EQ(sizes.of({"tag36h11", 6}), 0.2);
  EXPECT_EQ(sizes.of({"tag36h11", 7}), 0.1);
  EXPECT_EQ(sizes.of({"tag25h9", 7}), 0.3);
}

TEST(MarkerSizes, RefusesWhatNamesNoMarkerOrNoSize) {
  const auto refused = [](const MarkerSizes& sizes) { EXPECT_THROW(validate(sizes), std::invalid_argument); };
  refused({0.0, {}});
  refused({0.2, {{"seven", 0.1}}});
  refused({0.2, {{"tag99/7", 0.1}}});
  refused({0.2, {{"7", -0.1}}});
}

TEST(ObservedMarkers, PoseScalesWithTheSize) {
  // The same corners with twice the size lie twice as far away.
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const Pose truth = poseFromXyzRpy({0.1, 0.05, 1.0}, {M_PI + 0.4, 0.2, 0.1});
  Detection detection;
  detection.key = {"tag36h11", 7};
  for (int i = 0; i < 4; ++i) detection.corners[i] = *camera.project(truth * markerCorners(0.2)[i]);
  Detection other = detection;
  other.key.id = 8;
  const auto seen = observeMarkers(camera, {detection, other}, {0.2, {{"8", 0.4}}}, 0.3);
  ASSERT_EQ(seen.size(), 2u);
  ASSERT_TRUE(seen[0].poses && seen[1].poses && seen[0].covariance && seen[1].covariance);
  EXPECT_LT(poseError(truth, seen[0].poses->best.T_camera_marker).norm(), 1e-6);
  EXPECT_LT((seen[1].poses->best.T_camera_marker.translation() - 2 * truth.translation()).norm(), 1e-6);
  EXPECT_NEAR((*seen[1].covariance)(2, 2) / (*seen[0].covariance)(2, 2), 4.0, 1e-3);
}

TEST(ObservedMarkers, KeepsADetectionWithoutAPose) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  Detection flat;
  flat.key = {"tag36h11", 1};
  flat.corners.fill(Eigen::Vector2d(100, 100));
  const auto seen = observeMarkers(camera, {flat}, {}, 0.3);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_FALSE(seen[0].poses);
  EXPECT_FALSE(seen[0].covariance);
}

}  // namespace
}  // namespace sextant
