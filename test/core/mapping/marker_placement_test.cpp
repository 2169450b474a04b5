// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/marker_placement.hpp"

#include <gtest/gtest.h>

#include "sextant/mapping/map_growth.hpp"
#include "test_recording.hpp"

namespace sextant {
namespace {

constexpr int kPlaced = 5;

MarkerMap withoutPlaced(const MarkerMap& map) {
  MarkerMap rest;
  for (const auto& entry : map.markers())
    if (entry.first.id != kPlaced) rest.add(entry.second);
  return rest;
}

struct Scene {
  SimulatedRecording simulated;
  std::vector<RecordedObservation> observations;
  std::vector<InstantHypotheses> path;
};

Scene scene(int seed) {
  Scene made{drive(roomWithMarkers(12), 120, 0.3, seed), {}, {}};
  made.observations = observationsByMarker(made.simulated.recording).at(key(kPlaced));
  made.path = locateRecording(made.simulated.recording, withoutPlaced(made.simulated.truth), {});
  return made;
}

// With corner noise only, the covariance of the pose is consistent. 20 x 6 degrees of freedom have a standard
// deviation of 13 %.
TEST(MarkerPlacement, IsTheTruePlaceWithAnHonestCovariance) {
  double nees = 0;
  for (int seed = 0; seed < 20; ++seed) {
    const Scene made = scene(seed);
    const auto places = placeMarker(made.simulated.recording, made.observations, made.path, 0.2, {});
    ASSERT_FALSE(places.empty());
    EXPECT_GT(places[0].weight, 0.999);
    EXPECT_GT(places[0].agreement, 0.95);
    const Vector6d error =
        poseError(made.simulated.truth.find(key(kPlaced))->T_map_marker, places[0].T_map_marker);
    EXPECT_LT(error.head<3>().norm(), 0.05);
    nees += error.dot(places[0].covariance.inverse() * error) / (20 * 6);
  }
  EXPECT_NEAR(nees, 1.0, 0.45);
}

// From one distant head-on image, a square has two poses.
TEST(MarkerPlacement, OneImageLeavesTwo) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerMap truth;
  truth.add(
      {key(kPlaced), 0.2, "", poseFromXyzRpy({5, 0.3, 1.2}, {M_PI_2, 0.1, -M_PI_2 + 0.1}), Matrix6d::Zero()});
  std::mt19937 random(1);
  const MarkerRecording recording = {{{recordedView(truth, camera, Pose::Identity(), 0.3, random)}, {}, 0}};
  const std::vector<InstantHypotheses> path = {
      {{Pose::Identity(), 1e-8 * Matrix6d::Identity(), 0, 0, {0, 1}, 0, 1}}};
  const auto places = placeMarker(recording, {{0, 0, 0}}, path, 0.2, {});
  ASSERT_EQ(places.size(), 2u);
  EXPECT_GT(places[1].weight, 1e-3);
  const auto turn = [&](const MarkerPlace& place) {
    return logSO3(place.T_map_marker.linear().transpose() * truth.find(key(kPlaced))->T_map_marker.linear())
        .norm();
  };
  EXPECT_LT(std::min(turn(places[0]), turn(places[1])), 0.3);
  EXPECT_GT(std::max(turn(places[0]), turn(places[1])), 0.3);
}

TEST(MarkerPlacement, WithoutAPoseThereIsNoPlace) {
  const Scene made = scene(1);
  const std::vector<InstantHypotheses> nothing(made.simulated.recording.size());
  EXPECT_TRUE(placeMarker(made.simulated.recording, made.observations, nothing, 0.2, {}).empty());
  EXPECT_FALSE(
      distanceFromPlace(made.simulated.recording, made.observations[0], {}, 0.2, Pose::Identity(), {}));
}

TEST(MarkerPlacement, DistanceTellsAPlaceFromAnother) {
  const Scene made = scene(2);
  const Pose truth = made.simulated.truth.find(key(kPlaced))->T_map_marker;
  Pose moved = truth;
  moved.translation().z() += 0.1;
  int asked = 0;
  for (const RecordedObservation& each : made.observations) {
    const InstantHypotheses& bases = made.path[each.instant];
    if (bases.empty() || bases[0].used.size() < 2) continue;
    ++asked;
    EXPECT_LT(*distanceFromPlace(made.simulated.recording, each, bases, 0.2, truth, {}), 30);
    EXPECT_GT(*distanceFromPlace(made.simulated.recording, each, bases, 0.2, moved, {}), 30);
  }
  EXPECT_GT(asked, 10);
}

}  // namespace
}  // namespace sextant
