// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/map_growth.hpp"

#include <gtest/gtest.h>

#include "test_recording.hpp"

namespace sextant {
namespace {

// A corridor with a marker every metre on the wall y = 1, observed from 2 m: only neighbours are observed
// together.
MarkerMap corridor(int count) {
  MarkerMap map;
  for (int id = 0; id < count; ++id)
    map.add({key(id), 0.2, "",
             poseFromXyzRpy({1.0 * id, 1, 1 + 0.2 * (id % 3)}, {M_PI_2 + 0.03, 0, 0.02 * id}),
             Matrix6d::Zero()});
  return map;
}

MarkerRecording along(const MarkerMap& truth, double length, double sigma) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  std::mt19937 random(1);
  MarkerRecording recording;
  for (double x = 0; x < length; x += 0.1)
    recording.push_back({{recordedView(truth, camera,
                                       poseFromXyzRpy({x, -1 + 0.5 * std::sin(2 * x), 0},
                                                      {0, 0, M_PI_2 + 0.4 * std::sin(3 * x)}),
                                       sigma, random)},
                         {},
                         0});
  return recording;
}

TEST(MapGrowth, FollowsAChainToItsEnd) {
  const MarkerMap truth = corridor(8);
  const GrownMap grown = growMap(along(truth, 7, 0.05), {}, only(truth, {0}), {});
  ASSERT_EQ(grown.estimate.map.markers().size(), 8u);
  EXPECT_TRUE(grown.ambiguous.empty());
  for (const auto& [marker_key, marker] : truth.markers()) {
    const Vector6d error = poseError(marker.T_map_marker, grown.estimate.map.find(marker_key)->T_map_marker);
    EXPECT_LT(error.head<3>().norm(), 0.03 + 0.03 * marker_key.id) << marker_key.id;
    EXPECT_LT(error.tail<3>().norm(), 0.1) << marker_key.id;
  }
  EXPECT_GT(grown.estimate.map.find(key(7))->covariance.trace(),
            grown.estimate.map.find(key(1))->covariance.trace());
}

TEST(MapGrowth, WhatNothingConnectsIsNotAdded) {
  MarkerMap truth;
  const MarkerMap whole = corridor(12);
  for (const auto& [marker_key, marker] : whole.markers())
    if (marker_key.id < 4 || marker_key.id > 8) truth.add(marker);
  const GrownMap grown = growMap(along(truth, 12, 0.05), {}, only(truth, {0}), {});
  EXPECT_EQ(grown.estimate.map.markers().size(), 4u);
  EXPECT_TRUE(grown.ambiguous.empty());
}

TEST(MapGrowth, LeavesOutWhatItIsTold) {
  const MarkerMap truth = corridor(4);
  const GrownMap grown = growMap(along(truth, 3, 0.05), {}, only(truth, {0}), {}, {key(2)});
  EXPECT_EQ(grown.estimate.map.find(key(2)), nullptr);
  EXPECT_NE(grown.estimate.map.find(key(1)), nullptr);
}

TEST(ObservationsByMarker, MarkersThatAreTwiceInAnImageAreNoObservations) {
  const MarkerMap truth = corridor(3);
  MarkerRecording recording = along(truth, 0.15, 0);
  auto& detections = recording[0].views[0].detections;
  const auto before = observationsByMarker(recording);
  Detection twin = detections[0];
  twin.corners[0].x() += 100;
  detections.push_back(twin);
  const auto after = observationsByMarker(recording);
  EXPECT_EQ(after.at(twin.key).size(), before.at(twin.key).size() - 1);
}

}  // namespace
}  // namespace sextant
