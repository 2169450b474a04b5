// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/recorded_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "test_recording.hpp"

namespace sextant {
namespace {

TEST(RecordedPath, IsTheTrueOneWhereMarkersDecide) {
  const auto simulated = drive(roomWithMarkers(12), 60, 0.1, 1);
  const auto path = locateRecording(simulated.recording, simulated.truth, {});
  int several = 0;
  for (size_t i = 0; i < path.size(); ++i) {
    if (simulated.recording[i].views[0].detections.size() < 2) continue;
    ++several;
    ASSERT_TRUE(isUnambiguous(path[i], 0.999));
    const Vector6d error = poseError(simulated.T_map_base[i], path[i][0].T_map_base);
    EXPECT_LT(error.dot(path[i][0].covariance.inverse() * error), 30) << i;
  }
  EXPECT_GT(several, 40);
}

TEST(RecordedPath, IsEmptyWhereNothingIsKnown) {
  const auto simulated = drive(roomWithMarkers(12), 20, 0.1, 1);
  for (const auto& each : locateRecording(simulated.recording, MarkerMap(), {})) EXPECT_TRUE(each.empty());
}

// Odometry of another frame, exact; markers in the first and the last instant only.
TEST(RecordedPath, OdometryStandsInBetween) {
  auto simulated = drive(roomWithMarkers(24), 100, 0.1, 1);
  const Pose T_odom_map = poseFromXyzRpy({3, -1, 0}, {0, 0, 1.1});
  MarkerRecording& recording = simulated.recording;
  recording.resize(41);
  for (size_t i = 0; i < recording.size(); ++i) {
    recording[i].T_odom_base = T_odom_map * simulated.T_map_base[i];
    if (i != 0 && i != 40) recording[i].views[0].detections.clear();
  }
  ASSERT_GT(recording[0].views[0].detections.size(), 1u);
  ASSERT_GT(recording[40].views[0].detections.size(), 1u);
  const auto path = locateRecording(recording, simulated.truth, {});
  for (size_t i = 0; i < recording.size(); ++i) {
    ASSERT_EQ(path[i].size(), 1u) << i;
    EXPECT_LT(poseError(simulated.T_map_base[i], path[i][0].T_map_base).head<3>().norm(), 0.03) << i;
  }
  EXPECT_GT(path[20][0].covariance.trace(), path[1][0].covariance.trace());
  EXPECT_GT(path[20][0].covariance.trace(), path[39][0].covariance.trace());
  recording[10].T_odom_base.reset();  // a gap: from neither side
  recording[30].T_odom_base.reset();
  EXPECT_TRUE(locateRecording(recording, simulated.truth, {})[20].empty());
}

TEST(RecordedPath, KeepsWhatItIsGiven) {
  const auto simulated = drive(roomWithMarkers(12), 10, 0.1, 1);
  const Pose given = poseFromXyzRpy({7, 7, 7}, {0, 0, 0});
  std::vector<InstantHypotheses> kept(10);
  kept[3] = {{given, Matrix6d::Identity(), 0, 0, {0, 1}, 0, 1}};
  const auto path = locateRecording(simulated.recording, simulated.truth, {}, kept);
  EXPECT_TRUE(path[3][0].T_map_base.isApprox(given));
  EXPECT_FALSE(path[4][0].T_map_base.isApprox(given));
}

TEST(RecordedPath, LeavesOutMarkersThatDoNotCount) {
  auto simulated = drive(roomWithMarkers(24), 10, 0.1, 1);
  const RecordedInstant& instant = simulated.recording[0];
  const auto& detections = instant.views[0].detections;
  ASSERT_GT(detections.size(), 2u);
  const auto all = locateInstant(instant, simulated.truth, {}, {});
  const auto some = locateInstant(instant, simulated.truth, {}, {}, {detections[0].key});
  EXPECT_EQ(all[0].used.size(), detections.size());
  EXPECT_EQ(some[0].used.size(), detections.size() - 1);
}

}  // namespace
}  // namespace sextant
