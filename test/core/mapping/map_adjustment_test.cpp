// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/map_adjustment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "sextant/mapping/map_growth.hpp"
#include "test_recording.hpp"

namespace sextant {
namespace {

std::vector<RecordedObservation> allObservations(const MarkerRecording& recording) {
  std::vector<RecordedObservation> all;
  for (const auto& entry : observationsByMarker(recording))
    all.insert(all.end(), entry.second.begin(), entry.second.end());
  return all;
}

Pose disturbed(const Pose& pose, double size, std::mt19937& random) {
  std::normal_distribution<double> noise(0, size);
  Vector6d xi;
  for (int i = 0; i < xi.size(); ++i) xi(i) = noise(random);
  return perturbed(pose, xi);
}

// The truth with errors of a few centimetres, except for marker 0.
MapEstimate startOf(const SimulatedRecording& simulated, double size) {
  std::mt19937 random(3);
  MapEstimate start{MarkerMap(), {}};
  for (const auto& [marker_key, marker] : simulated.truth.markers()) {
    MappedMarker moved = marker;
    if (marker_key.id != 0) moved.T_map_marker = disturbed(marker.T_map_marker, size, random);
    start.map.add(moved);
  }
  for (const Pose& pose : simulated.T_map_base) start.T_map_base.emplace_back(disturbed(pose, size, random));
  return start;
}

Eigen::VectorXd errorsOf(const MarkerMap& truth, const MarkerMap& estimate) {
  Eigen::VectorXd errors(static_cast<Eigen::Index>(6 * truth.markers().size()));
  Eigen::Index row = 0;
  for (const auto& [marker_key, marker] : truth.markers()) {
    errors.segment<6>(row) = poseError(marker.T_map_marker, estimate.find(marker_key)->T_map_marker);
    row += 6;
  }
  return errors;
}

TEST(MapAdjustment, ExactCornersLeadBackToTheTruth) {
  const auto simulated = drive(roomWithMarkers(8), 60, 0, 1);
  const auto found = adjustMap(simulated.recording, allObservations(simulated.recording),
                               only(simulated.truth, {0}), startOf(simulated, 0.03), {});
  ASSERT_TRUE(found);
  EXPECT_LT(errorsOf(simulated.truth, found->map).norm(), 1e-6);
  for (const RecordedObservation& each : allObservations(simulated.recording))
    EXPECT_LT(poseError(simulated.T_map_base[each.instant], *found->T_map_base[each.instant]).norm(), 1e-6);
}

// NEES of all free markers together averages to their degrees of freedom: chi-square of 30 * 42 has a
// deviation of 4 %.
TEST(MapAdjustment, ItsCovarianceIsHonest) {
  const double sigma = 0.3;
  double nees = 0;
  for (int seed = 0; seed < 30; ++seed) {
    const auto simulated = drive(roomWithMarkers(8), 60, sigma, seed);
    const auto used = allObservations(simulated.recording);
    const MarkerMap known = only(simulated.truth, {0});
    const auto found = adjustMap(simulated.recording, used, known, startOf(simulated, 0.01), {});
    ASSERT_TRUE(found);
    const auto covariance = mapCovariance(simulated.recording, used, known, *found, {});
    ASSERT_TRUE(covariance);
    EXPECT_TRUE((covariance->topLeftCorner<6, 6>().isZero(0.0)));  // held
    const Eigen::VectorXd free = errorsOf(simulated.truth, found->map).tail(42);
    nees += free.dot(covariance->bottomRightCorner(42, 42).ldlt().solve(free)) / (30 * 42);
  }
  EXPECT_NEAR(nees, 1.0, 0.12);
}

// Two markers that are never seen together: the transform between them comes from odometry, and so does its
// uncertainty. Seen from the place where it is looked at, a marker is exact here.
TEST(MapAdjustment, OdometryConnectsWhatIsNeverSeenTogether) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerMap truth;
  for (int id = 0; id < 2; ++id)
    truth.add(
        {key(id), 0.2, "", poseFromXyzRpy({1.0 + 2 * id, 0, 1}, {M_PI_2, 0, -M_PI_2}), Matrix6d::Zero()});
  std::mt19937 random(1);
  MarkerRecording recording;
  BasePath path;
  for (int id = 0; id < 2; ++id) {
    path.emplace_back(poseFromXyzRpy({2.0 * id, 0, 0}, {0, 0, 0}));
    recording.push_back(
        {{recordedView(only(truth, {id}), camera, *path.back(), 0, random)}, *path.back(), 0});
  }
  AdjustmentParams params;
  params.corner_sigma = 1e-3;
  params.odometry.position_drift = 0.05;
  params.odometry.heading_drift = params.odometry.turn_drift = 1e-6;
  const MarkerMap known = only(truth, {0});
  const auto used = allObservations(recording);
  const auto covariance = mapCovariance(recording, used, known, {truth, path}, params);
  ASSERT_TRUE(covariance);
  const double along = 0.05 * std::sqrt(2.0);  // the deviation of an axis after 2 m
  EXPECT_NEAR(std::sqrt((*covariance)(6, 6)), along, 0.02 * along);
  recording[1].drive = 1;  // another day: nothing connects the two
  EXPECT_FALSE(mapCovariance(recording, used, known, {truth, path}, params));
}

// Two known markers that disagree by 3 cm, one twice as exact as the other: the mean, by their weights.
TEST(MapAdjustment, KnownMarkersDrawByTheirCovariance) {
  const auto simulated = drive(roomWithMarkers(8), 60, 0, 1);
  MarkerMap known;
  for (const int id : {0, 4}) {
    MappedMarker marker = *simulated.truth.find(key(id));
    marker.covariance = tapeCovariance(id == 0 ? 0.02 : 0.01, 1e-4);
    if (id == 4) marker.T_map_marker.translation().z() += 0.03;
    known.add(marker);
  }
  const auto found = adjustMap(simulated.recording, allObservations(simulated.recording), known,
                               startOf(simulated, 0.01), {});
  ASSERT_TRUE(found);
  const Eigen::VectorXd errors = errorsOf(simulated.truth, found->map);
  // Inverse variances 1 : 4, and nothing turns.
  EXPECT_NEAR(-errors[2], 0.024, 0.002);
  EXPECT_NEAR(-errors[6 * 4 + 2], 0.024, 0.002);
}

// A marker known to a metre and half a radian: the floor determines only height, roll and pitch.
TEST(MapAdjustment, TheFloorHoldsHeightAndTilt) {
  const auto simulated = drive(roomWithMarkers(8), 60, 0.3, 1);
  const MarkerMap known = only(simulated.truth, {0}, tapeCovariance(1.0, 0.5));
  const MapEstimate truth = startOf(simulated, 0);
  AdjustmentParams params;
  params.floor = FloorPrior{0.01, 0.01};
  const auto covariance =
      mapCovariance(simulated.recording, allObservations(simulated.recording), known, truth, params);
  ASSERT_TRUE(covariance);
  const Vector6d sigmas = covariance->diagonal().head<6>().cwiseSqrt();
  EXPECT_NEAR(sigmas[0], 1.0, 0.05);
  EXPECT_NEAR(sigmas[1], 1.0, 0.05);
  EXPECT_NEAR(sigmas[5], 0.5, 0.05);
  EXPECT_LT(sigmas[2], 0.01);
  EXPECT_LT(sigmas.segment<2>(3).maxCoeff(), 0.01);
}

// A camera that is not as calibrated: estimated with the map, so that its error does not become one of the
// map.
TEST(MapAdjustment, FindsTheErrorOfTheLens) {
  auto simulated = drive(roomWithMarkers(8), 60, 0, 1);
  const LensCorrection lens = 0.4 * LensCorrection::LinSpaced(-2, 2);
  addLensError(simulated.recording, lens);
  AdjustmentParams params;
  const auto used = allObservations(simulated.recording);
  const MarkerMap known = only(simulated.truth, {0});
  const MapEstimate start = startOf(simulated, 0.01);
  const auto without = adjustMap(simulated.recording, used, known, start, params);
  params.lens_sigma = 100;  // hardly any prior
  const auto found = adjustMap(simulated.recording, used, known, start, params);
  ASSERT_TRUE(found && without);
  EXPECT_TRUE(without->lenses.at(0).isZero(0.0));
  EXPECT_LT((found->lenses.at(0) - lens).norm(), 0.01 * lens.norm());
  EXPECT_LT(errorsOf(simulated.truth, found->map).norm(),
            0.01 * errorsOf(simulated.truth, without->map).norm());
}

TEST(MapAdjustment, WithoutObservationsThereIsNothingToDo) {
  EXPECT_FALSE(adjustMap({}, {}, MarkerMap(), {MarkerMap(), {}}, {}));
  EXPECT_FALSE(mapCovariance({}, {}, MarkerMap(), {MarkerMap(), {}}, {}));
}

}  // namespace
}  // namespace sextant
