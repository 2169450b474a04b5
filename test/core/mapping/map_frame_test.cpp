// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_frame.hpp"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <vector>

#include "test_recording.hpp"

namespace sextant {
namespace {

// An instant at which one camera observes these markers.
RecordedInstant instantWith(const std::vector<int>& ids, const std::optional<Pose>& T_odom_base = {}) {
  MarkerView view{CameraModel(testCalibrations()[0], CameraModel::Image::raw), kRecordingMount, {}};
  for (const int id : ids) {
    view.detections.emplace_back();
    view.detections.back().key = key(id);
  }
  return {{view}, T_odom_base, 0};
}

int firstOf(const MarkerRecording& recording, const std::set<MarkerKey>& without = {}) {
  const MarkerMap map = firstMarker("hall", recording, {}, without);
  EXPECT_EQ(map.frame(), "hall");
  EXPECT_EQ(map.markers().size(), 1u);
  return map.markers().begin()->first.id;
}

TEST(FirstMarker, IsTheFirstOfTheLargestIsland) {
  const MarkerRecording recording = {instantWith({1, 2}), instantWith({7, 5}), instantWith({5, 9}),
                                     instantWith({})};
  EXPECT_EQ(firstOf(recording), 5);
  EXPECT_EQ(firstOf(recording, {key(5)}), 1);  // 7 and 9 have nothing in common without it
  MarkerRecording driven = {instantWith({1, 2}, Pose::Identity()), instantWith({5, 7, 9}),
                            instantWith({3}, Pose::Identity()), instantWith({4}, Pose::Identity())};
  EXPECT_EQ(firstOf(driven), 1);  // by odometry
  driven[2].drive = driven[3].drive = 1;
  EXPECT_EQ(firstOf(driven), 5);
  EXPECT_THROW(firstMarker("map", {instantWith({})}, {}, {}), std::runtime_error);
}

TEST(ConnectedMarkers, AreThoseThatUsedObservationsConnect) {
  MarkerRecording recording = {instantWith({1, 2}), instantWith({2, 3}), instantWith({3, 4})};
  std::vector<RecordedObservation> all;
  for (size_t i = 0; i < recording.size(); ++i)
    for (size_t d = 0; d < 2; ++d) all.push_back({i, 0, d});
  MarkerMap map;
  map.add({key(1), 0.2, "", Pose::Identity(), Matrix6d::Zero()});
  using Keys = std::set<MarkerKey>;
  EXPECT_TRUE(connectedMarkers(recording, all, map) == Keys({key(1), key(2), key(3), key(4)}));
  all.erase(all.begin() + 3);  // 3 in the second instant
  EXPECT_TRUE(connectedMarkers(recording, all, map) == Keys({key(1), key(2)}));
  for (RecordedInstant& instant : recording) instant.T_odom_base = Pose::Identity();
  EXPECT_TRUE(connectedMarkers(recording, all, map) == Keys({key(1), key(2), key(3), key(4)}));
}

TEST(FirstMarker, HangsUprightInTheOriginAndLooksAlongMinusY) {
  MarkerSizes sizes;
  sizes.sizes["5"] = 0.4;
  const MarkerMap map = firstMarker("map", {instantWith({5})}, sizes, {});
  const MappedMarker& first = map.markers().begin()->second;
  EXPECT_EQ(first.size, 0.4);
  EXPECT_TRUE(first.T_map_marker.translation().isZero());
  EXPECT_TRUE(first.T_map_marker.linear().col(2).isApprox(-Eigen::Vector3d::UnitY(), 1e-15));
  EXPECT_TRUE(first.T_map_marker.linear().col(1).isApprox(Eigen::Vector3d::UnitZ(), 1e-15));
}

// A room with a horizontal path, in the frame of a tilted marker at a height of 1 m.
TEST(PutOnFloor, LevelsThePathAndKeepsTheShape) {
  const MarkerMap truth = roomWithMarkers(6);
  const Pose T_new_truth =
      poseFromXyzRpy({0, 0, 0}, {0.3, -0.2, 1}) * truth.find(key(2))->T_map_marker.inverse();
  MapEstimate estimate;
  for (auto [marker_key, marker] : truth.markers()) {
    marker.T_map_marker = T_new_truth * marker.T_map_marker;
    estimate.map.add(marker);
  }
  for (int i = 0; i < 10; ++i) estimate.T_map_base.emplace_back(T_new_truth * poseOnTheWay(0.1 * i));
  estimate.T_map_base[3].reset();
  const MarkerMap held = putOnFloor(key(2), estimate);
  const Pose first = estimate.map.find(key(2))->T_map_marker;
  const Pose T_floor_truth = first * truth.find(key(2))->T_map_marker.inverse();
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(estimate.T_map_base[i].has_value(), i != 3);
    if (i == 3) continue;
    EXPECT_NEAR(estimate.T_map_base[i]->translation().z(), 0, 1e-12);
    EXPECT_NEAR(estimate.T_map_base[i]->linear()(2, 2), 1, 1e-12);
    EXPECT_LT(poseError(*estimate.T_map_base[i], T_floor_truth * poseOnTheWay(0.1 * i)).norm(), 1e-12);
  }
  EXPECT_LT(first.translation().head<2>().norm(), 1e-12);
  EXPECT_NEAR(first.translation().z(), truth.find(key(2))->T_map_marker.translation().z(), 1e-12);
  EXPECT_NEAR(first.linear()(0, 2), 0, 1e-12);
  EXPECT_LT(first.linear()(1, 2), -0.9);
  for (const auto& [marker_key, marker] : truth.markers())
    EXPECT_LT(
        poseError(estimate.map.find(marker_key)->T_map_marker, T_floor_truth * marker.T_map_marker).norm(),
        1e-12);
  const Vector6d sigmas = held.find(key(2))->covariance.diagonal().cwiseSqrt();
  for (const int held_axis : {0, 1, 5}) EXPECT_LT(sigmas[held_axis], 1e-5);
  for (const int free_axis : {2, 3, 4}) EXPECT_GT(sigmas[free_axis], 1);
}

}  // namespace
}  // namespace sextant
