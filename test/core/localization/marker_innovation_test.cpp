// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_innovation.hpp"

#include <gtest/gtest.h>

#include "sextant/localization/mapped_observation.hpp"
#include "test_cameras.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

// Three markers on one wall, and one on another.
struct Innovation {
  explicit Innovation(int seed, double sigma = 0.3)
      : view(look(room(), CameraModel(testCalibrations()[1], CameraModel::Image::raw), kTruth, sigma, seed)) {
    for (const Detection& detection : view.detections)
      observations.push_back(mappedObservation(view, detection, *room().find(detection.key), sigma));
  }

  PoseHypothesis fitOf(const std::vector<MarkerObservation>& some) const {
    return poseHypotheses(some, {{kTruth, 0}}, {}, std::nullopt).at(0);
  }
  Pose T_camera_marker() const {
    return solveMarkerPose(view.camera, view.detections[3].corners, 0.3)->best.T_camera_marker;
  }
  std::optional<MarkerInnovation> ofTheLast(const PoseHypothesis& pose, bool used) const {
    return markerInnovation(observations[3], T_camera_marker(), pose, used);
  }

  MarkerView view;
  std::vector<MarkerObservation> observations;
};

TEST(MarkerInnovation, IsThatOfAFitWithoutTheMarker) {
  for (int seed = 0; seed < 10; ++seed) {
    const Innovation all(seed, 0.03);
    const auto others = all.fitOf({all.observations.begin(), all.observations.end() - 1});
    const auto by_downdate = all.ofTheLast(all.fitOf(all.observations), true);
    const auto by_fit = all.ofTheLast(others, false);
    ASSERT_TRUE(by_downdate && by_fit);
    EXPECT_NEAR(by_downdate->squared_distance, by_fit->squared_distance, 0.05 * by_fit->squared_distance);
    EXPECT_LT((by_downdate->p_map - by_fit->p_map).norm(), 1e-3);
    EXPECT_LT((by_downdate->p_covariance - by_fit->p_covariance).norm(), 0.05 * by_fit->p_covariance.norm());
  }
}

TEST(MarkerInnovation, IsChiSquareOfItsEightCoordinates) {
  double squared = 0, position = 0;
  const int frames = 200;
  for (int seed = 0; seed < frames; ++seed) {
    const Innovation all(seed);
    const auto innovation = all.ofTheLast(all.fitOf(all.observations), true);
    squared += innovation->squared_distance / frames;
    const Eigen::Vector3d off = innovation->p_map - all.observations[3].T_map_marker.translation();
    position += off.dot(innovation->p_covariance.inverse() * off) / frames;
  }
  EXPECT_NEAR(squared, 8, 3 * 4 / std::sqrt(frames));
  EXPECT_NEAR(position, 3, 3 * std::sqrt(6.0 / frames));
}

TEST(MarkerInnovation, WithoutOthersThereIsNone) {
  const Innovation all(1);
  EXPECT_FALSE(all.ofTheLast(all.fitOf({all.observations[3]}), true));
  EXPECT_TRUE(all.ofTheLast(all.fitOf({all.observations[0], all.observations[1]}), false));
}

}  // namespace
}  // namespace sextant
