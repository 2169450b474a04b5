// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_draft.hpp"

#include <gtest/gtest.h>

#include "test_recording.hpp"

namespace sextant {
namespace {

TEST(MapDraft, IsTheTruthWhereCornersAreExact) {
  const auto simulated = drive(roomWithMarkers(10), 60, 0, 1);
  const MarkerSizes sizes;
  const MappingParams params;
  MapDraft draft(simulated.recording, sizes, only(simulated.truth, {0}), params);
  draft.make();
  EXPECT_TRUE(draft.ambiguous.empty() && draft.inconsistent.empty() && draft.conflicting_poses.empty());
  ASSERT_EQ(draft.fit.estimate.map.markers().size(), 10u);
  for (const auto& [marker_key, marker] : simulated.truth.markers())
    EXPECT_LT(poseError(marker.T_map_marker, draft.fit.estimate.map.find(marker_key)->T_map_marker).norm(),
              1e-5);
  EXPECT_EQ(draft.fit.unexplained(), 0u);
}

TEST(MapDraft, OneMarkerSaysNothingOfTheMapUnlessTheFloorOrOdometryDoes) {
  auto simulated = drive(roomWithMarkers(4), 60, 0, 1);
  const MarkerSizes sizes;
  MappingParams params;
  const auto informativeOf = [&] {
    MapDraft draft(simulated.recording, sizes, simulated.truth, params);
    draft.fit.estimate = {simulated.truth, {simulated.T_map_base.begin(), simulated.T_map_base.end()}};
    return std::make_pair(draft.informative(draft.fit.placed()), draft.fit.placed().size());
  };
  const auto [some, all] = informativeOf();
  EXPECT_LT(some.size(), all);
  EXPECT_GT(some.size(), 0u);
  for (const RecordedObservation& each : some)
    EXPECT_GT(simulated.recording[each.instant].views[0].detections.size(), 1u);
  params.floor_height_sigma = 0.01;
  EXPECT_EQ(informativeOf().first.size(), all);
  params.floor_height_sigma = 0;
  for (RecordedInstant& instant : simulated.recording) instant.T_odom_base = Pose::Identity();
  EXPECT_EQ(informativeOf().first.size(), all);
}

TEST(MapDraft, LocatesWhatWasNotAdjusted) {
  const auto simulated = drive(roomWithMarkers(12), 40, 0, 1);
  const MarkerSizes sizes;
  const MappingParams params;
  MapDraft draft(simulated.recording, sizes, simulated.truth, params);
  draft.fit.estimate = {simulated.truth, BasePath(simulated.T_map_base.size(), Pose::Identity())};
  size_t several = 0;
  draft.locateRemainingInstants({});
  for (size_t i = 0; i < simulated.T_map_base.size(); ++i) {
    if (simulated.recording[i].views[0].detections.size() < 2) continue;
    ++several;
    ASSERT_TRUE(draft.fit.estimate.T_map_base[i]);
    EXPECT_LT(poseError(simulated.T_map_base[i], *draft.fit.estimate.T_map_base[i]).norm(), 1e-6);
  }
  EXPECT_GT(several, 10u);
}

}  // namespace
}  // namespace sextant
