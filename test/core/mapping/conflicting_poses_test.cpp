// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/conflicting_poses.hpp"

#include <gtest/gtest.h>

#include "sextant/mapping/map_growth.hpp"
#include "test_recording.hpp"

namespace sextant {
namespace {

std::vector<InstantHypotheses> nothingExplained(const MarkerRecording& recording) {
  return std::vector<InstantHypotheses>(recording.size());
}

TEST(ConflictingPoses, AreNoneWhereTheMapIsRight) {
  const auto simulated = drive(roomWithMarkers(12), 120, 0.3, 1);
  EXPECT_TRUE(
      conflictingPoses(simulated.recording, simulated.truth, nothingExplained(simulated.recording), {})
          .empty());
}

// In the middle of the drive a marker is moved.
TEST(ConflictingPoses, AMovedMarkerComesFirst) {
  const MarkerMap before = roomWithMarkers(12);
  MarkerMap after = before;
  MappedMarker moved = *before.find(key(5));
  moved.T_map_marker.translation().z() += 0.3;
  after.set(moved);
  auto simulated = drive(before, 120, 0.3, 1);
  const auto second = drive(after, 120, 0.3, 2).recording;
  std::copy(second.begin() + 60, second.end(), simulated.recording.begin() + 60);
  const auto found = conflictingPoses(simulated.recording, before, nothingExplained(simulated.recording), {});
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(found[0].key == key(5));
  EXPECT_GE(found[0].images, 5u);
  EXPECT_GE(found[0].witnesses.size(), 2u);
  EXPECT_LT(poseError(moved.T_map_marker, found[0].T_map_marker).norm(), 0.1);
}

}  // namespace
}  // namespace sextant
