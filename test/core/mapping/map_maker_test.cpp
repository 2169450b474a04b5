// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/map_maker.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <ctime>
#include <stdexcept>

#include "test_recording.hpp"

namespace sextant {
namespace {

Vector6d errorOf(const SimulatedRecording& simulated, const MappingResult& made, int id) {
  return poseError(simulated.truth.find(key(id))->T_map_marker, made.map.find(key(id))->T_map_marker);
}

TEST(MapMaker, OneKnownMarkerSufficesAndTheCovarianceIsHonest) {
  double nees = 0;
  const int drives = 12, markers = 10;
  for (int seed = 0; seed < drives; ++seed) {
    const auto simulated = drive(roomWithMarkers(markers), 150, 0.2, seed);
    const MappingResult made = makeMarkerMap(simulated.recording, {}, only(simulated.truth, {0}), {});
    ASSERT_EQ(made.map.markers().size(), static_cast<size_t>(markers));
    EXPECT_TRUE(made.ambiguous.empty() && made.unconnected.empty() && made.conflicting_poses.empty());
    EXPECT_TRUE(made.map.find(key(0))->covariance.isZero(0.0));
    EXPECT_NEAR(made.noise_scales.at(0), 0.2 / 0.3, 0.07);
    EXPECT_DOUBLE_EQ(made.correlated_images, 1.0);
    Eigen::VectorXd errors(6 * (markers - 1));
    for (int id = 1; id < markers; ++id) errors.segment<6>(6 * (id - 1)) = errorOf(simulated, made, id);
    const Eigen::MatrixXd P = made.covariance.bottomRightCorner(errors.size(), errors.size());
    nees += errors.dot(P.ldlt().solve(errors)) / static_cast<double>(errors.size() * drives);
    EXPECT_LT((made.map.find(key(5))->covariance - P.block<6, 6>(24, 24)).norm(), 1e-12);
  }
  EXPECT_NEAR(nees, 1.0, 0.15);  // chi-square of 648 degrees of freedom has a deviation of 6 %
}

// Errors of successive images that are nearly the same, and a lens that is not quite as calibrated.
TEST(MapMaker, CorrelatedErrorsAndTheLensAreInTheCovariance) {
  double nees = 0;
  const int drives = 6, markers = 20;
  std::mt19937 random(4);
  std::normal_distribution<double> lens_error(0, 0.5);
  for (int seed = 0; seed < drives; ++seed) {
    auto simulated = drive(roomWithMarkers(markers), 400, 0.1, seed);
    addSlowErrors(simulated.recording, 0.1, 0.8, seed);
    LensCorrection lens;
    for (Eigen::Index i = 0; i < lens.size(); ++i) lens[i] = lens_error(random);
    addLensError(simulated.recording, lens);
    const MappingResult made = makeMarkerMap(simulated.recording, {}, only(simulated.truth, {0}), {});
    ASSERT_EQ(made.map.markers().size(), static_cast<size_t>(markers));
    EXPECT_NEAR(made.correlated_images, 1 + 2 * 0.5 * 0.8 / (1 - 0.8), 1.5);
    Eigen::VectorXd errors(6 * (markers - 1));
    for (int id = 1; id < markers; ++id) errors.segment<6>(6 * (id - 1)) = errorOf(simulated, made, id);
    const Eigen::MatrixXd P = made.covariance.bottomRightCorner(errors.size(), errors.size());
    nees += errors.dot(P.ldlt().solve(errors)) / static_cast<double>(errors.size() * drives);
  }
  EXPECT_NEAR(nees, 1.0, 0.2);  // chi-square of 684 degrees of freedom has a deviation of 5 %
}

// Forty markers in every image, and one that is moved in the middle of the drive.
TEST(MapMaker, ABadMarkerAmongManyIsFoundInGoodTime) {
  const MarkerMap before = roomWithMarkers(120);
  MarkerMap after = before;
  MappedMarker moved = *before.find(key(50));
  moved.T_map_marker.translation().z() += 0.2;
  after.set(moved);
  auto simulated = drive(before, 200, 0.2, 1);
  const auto begin = std::clock();
  makeMarkerMap(simulated.recording, {}, only(before, {0}), {});
  const auto with_good_markers = std::clock() - begin;
  const auto second = drive(after, 200, 0.2, 2).recording;
  std::copy(second.begin() + 100, second.end(), simulated.recording.begin() + 100);
  const auto begin_with_bad = std::clock();
  const MappingResult made = makeMarkerMap(simulated.recording, {}, only(before, {0}), {});
  const auto with_bad_marker = std::clock() - begin_with_bad;
  EXPECT_LT(with_bad_marker, 4 * with_good_markers);
  ASSERT_EQ(made.inconsistent.size(), 1u);
  EXPECT_EQ(made.map.markers().size(), 119u);
  EXPECT_TRUE(made.inconsistent[0] == key(50));
  for (const auto& entry : made.map.markers())
    EXPECT_LT(errorOf(simulated, made, entry.first.id).norm(), 0.05) << entry.first.id;
}

TEST(MapMaker, EstimatesTheErrorOfTheCalibration) {
  auto simulated = drive(roomWithMarkers(20), 150, 0.1, 1);
  const CameraModel& camera = simulated.recording[0].views[0].camera;
  LensCorrection lens = LensCorrection::Zero();
  lens.segment<3>(2) << 2, 2, -1;  // focal lengths and distortion
  const MarkerMap known = only(simulated.truth, {0});
  EXPECT_LT(makeMarkerMap(simulated.recording, {}, known, {}).lens_errors.at(0), 0.4);
  addLensError(simulated.recording, lens);
  const auto made = makeMarkerMap(simulated.recording, {}, known, {});
  EXPECT_NEAR(made.lens_errors.at(0), lensDisplacement(camera, lens), 0.4);
}

// At rest, a robot has the same image, with the same errors, again and again.
TEST(MapMaker, ARobotAtRestLearnsNothingNew) {
  auto simulated = drive(roomWithMarkers(10), 100, 0.2, 1);
  const MarkerMap known = only(simulated.truth, {0});
  const MappingResult before = makeMarkerMap(simulated.recording, {}, known, {});
  for (int i = 0; i < 400; ++i) {
    simulated.recording.push_back(simulated.recording[99]);
    simulated.T_map_base.push_back(simulated.T_map_base[99]);
  }
  const MappingResult made = makeMarkerMap(simulated.recording, {}, known, {});
  EXPECT_LT((made.covariance - before.covariance).norm(), 1e-9);
  ASSERT_EQ(made.T_map_base.size(), 500u);
  for (const size_t i : {0, 100, 499})
    EXPECT_LT(poseError(simulated.T_map_base[i], *made.T_map_base[i]).norm(), 0.05) << i;
}

TEST(MapMaker, WithoutAKnownMarkerTheFirstHangsInTheOrigin) {
  const auto simulated = drive(roomWithMarkers(10), 150, 0.05, 1);
  const MappingResult made = makeMarkerMap(simulated.recording, {}, MarkerMap(), {});
  ASSERT_EQ(made.map.markers().size(), 10u);
  const Pose first = made.map.find(key(0))->T_map_marker;
  EXPECT_LT(poseError(poseFromXyzRpy({0, 0, 0}, {M_PI_2, 0, 0}), first).norm(), 1e-9);
  const Pose T_truth_map = simulated.truth.find(key(0))->T_map_marker * first.inverse();
  for (const auto& [marker_key, marker] : made.map.markers()) {
    const Pose truth = simulated.truth.find(marker_key)->T_map_marker;
    EXPECT_LT(poseError(truth, T_truth_map * marker.T_map_marker).norm(), 0.03) << marker_key.id;
  }
}

// The path determines the horizontal plane, although no marker is exactly upright.
TEST(MapMaker, TheFloorTellsWhatIsLevel) {
  const auto simulated = drive(roomWithMarkers(10), 150, 0.05, 1);
  MappingParams params;
  params.floor_height_sigma = 0.005;
  params.floor_tilt_sigma = 0.005;
  const MappingResult made = makeMarkerMap(simulated.recording, {}, MarkerMap(), params);
  const Pose first = made.map.find(key(0))->T_map_marker;
  EXPECT_LT(first.translation().head<2>().norm(), 1e-4);
  EXPECT_NEAR(first.translation().z(), simulated.truth.find(key(0))->T_map_marker.translation().z(), 0.01);
  EXPECT_NEAR(std::atan2(first.linear()(1, 2), first.linear()(0, 2)), -M_PI_2, 1e-3);
  for (const auto& pose : made.T_map_base) {
    if (!pose) continue;
    EXPECT_LT(std::abs(pose->translation().z()), 0.01);
    EXPECT_GT(pose->linear()(2, 2), 0.9999);
  }
}

TEST(MapMaker, NamesTheWrongEntriesOfATapedMapAndNoOthers) {
  const auto simulated = drive(roomWithMarkers(16), 200, 0.3, 1);
  std::mt19937 random(2);
  std::normal_distribution<double> tape(0, 0.005);
  MarkerMap taped;
  for (auto [marker_key, marker] : simulated.truth.markers()) {
    marker.T_map_marker.translation() += Eigen::Vector3d{tape(random), tape(random), tape(random)};
    if (marker_key.id == 3) marker.T_map_marker.translation().x() += 0.1;
    if (marker_key.id == 9) marker.T_map_marker.translation().z() -= 0.1;
    marker.covariance = tapeCovariance(0.01, 0.02);
    taped.add(marker);
  }
  const MappingResult made = makeMarkerMap(simulated.recording, {}, taped, {});
  for (const KnownMarkerCheck& check : made.known) {
    EXPECT_EQ(check.wrong, check.key.id == 3 || check.key.id == 9) << check.key.id;
    const Eigen::Vector3d wrong(check.key.id == 3 ? -0.1 : 0, 0, check.key.id == 9 ? 0.1 : 0);
    EXPECT_LT((check.offset.head<3>() - wrong).norm(), 0.03) << check.key.id;
  }
  EXPECT_EQ(made.known.size(), 16u);
  for (int id = 0; id < 16; ++id) EXPECT_LT(errorOf(simulated, made, id).head<3>().norm(), 0.01) << id;
}

// Known markers with errors of 2 cm and a standard deviation of 1 mm, which is scaled.
TEST(MapMaker, MeasuresHowFarKnownMarkersCanBeBelieved) {
  const auto simulated = drive(roomWithMarkers(16), 200, 0.1, 1);
  std::mt19937 random(2);
  std::normal_distribution<double> tape(0, 0.02);
  MarkerMap taped;
  for (auto [marker_key, marker] : simulated.truth.markers()) {
    marker.T_map_marker.translation() += Eigen::Vector3d{tape(random), tape(random), tape(random)};
    marker.covariance = tapeCovariance(0.001, 0.01);
    taped.add(marker);
  }
  const MappingResult made = makeMarkerMap(simulated.recording, {}, taped, {});
  EXPECT_GT(made.known_position_scale, 12);
  EXPECT_LT(made.known_position_scale, 30);
  EXPECT_TRUE(
      std::none_of(made.known.begin(), made.known.end(), [](const auto& each) { return each.wrong; }));
}

TEST(MapMaker, AMarkerThatIsThereTwiceIsLeftOutAndNamed) {
  auto simulated = drive(roomWithMarkers(12), 200, 0.2, 1);
  for (RecordedInstant& instant : simulated.recording)
    for (Detection& detection : instant.views[0].detections)
      if (detection.key.id == 7) detection.key.id = 4;  // the print of 4 hangs where 7 was, too
  const MappingResult made = makeMarkerMap(simulated.recording, {}, only(simulated.truth, {0}), {});
  EXPECT_EQ(made.map.find(key(4)), nullptr);
  ASSERT_EQ(made.inconsistent.size(), 1u);
  EXPECT_TRUE(made.inconsistent[0] == key(4));
  for (const auto& entry : made.map.markers())
    EXPECT_LT(errorOf(simulated, made, entry.first.id).norm(), 0.05) << entry.first.id;
}

TEST(MapMaker, MarkersThatNothingConnectsAreNamed) {
  auto simulated = drive(roomWithMarkers(8), 100, 0.2, 1);
  Detection stranger = simulated.recording[0].views[0].detections.at(0);
  stranger.key = key(99);
  simulated.recording.push_back(simulated.recording[0]);
  simulated.recording.back().views[0].detections = {stranger};
  const MappingResult made = makeMarkerMap(simulated.recording, {}, only(simulated.truth, {0}), {});
  EXPECT_EQ(made.map.find(key(99)), nullptr);
  ASSERT_EQ(made.unconnected.size(), 1u);
  EXPECT_TRUE(made.unconnected[0] == key(99));
}

TEST(MapMaker, FalseDetectionsDoNoHarm) {
  auto simulated = drive(roomWithMarkers(10), 150, 0.2, 1);
  for (size_t i = 0; i < simulated.recording.size(); i += 7)
    for (Detection& detection : simulated.recording[i].views[0].detections) {
      for (auto& corner : detection.corners) corner.x() += 15;
      break;  // the first
    }
  const MappingResult made = makeMarkerMap(simulated.recording, {}, only(simulated.truth, {1}), {});
  for (const auto& entry : made.map.markers())
    EXPECT_LT(errorOf(simulated, made, entry.first.id).norm(), 0.05) << entry.first.id;
  const auto left_out = std::count_if(made.residuals.begin(), made.residuals.end(),
                                      [](const ObservationResidual& each) { return !each.used; });
  EXPECT_GT(left_out, 10);
}

TEST(MapMaker, SaysWhyThereIsNoMap) {
  EXPECT_THROW(makeMarkerMap({}, {}, MarkerMap(), {}), std::runtime_error);
  const auto simulated = drive(roomWithMarkers(8), 50, 0.2, 1);
  MarkerMap elsewhere;
  elsewhere.add({{"tag36h11", 400}, 0.2, "", Pose::Identity(), Matrix6d::Zero()});
  try {
    makeMarkerMap(simulated.recording, {}, elsewhere, {});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("known markers"), std::string::npos);
  }
}

TEST(MappingParams, NamesTheFirstFieldOutOfRange) {
  MappingParams params;
  EXPECT_NO_THROW(validate(params));
  params.gate = 1;
  EXPECT_THROW(validate(params), std::invalid_argument);
  params = {};
  params.odometry.position_drift = -1;
  EXPECT_THROW(validate(params), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
