// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_timeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "test_landmark_drive.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

void expectSame(const LandmarkTimeline& a, const LandmarkTimeline& b, double tolerance) {
  const auto x = a.now(), y = b.now();
  ASSERT_TRUE(x && y);
  EXPECT_EQ(x->stamp, y->stamp);
  EXPECT_LE((x->T_map_base.position - y->T_map_base.position).norm(), tolerance);
  EXPECT_NEAR(x->T_map_base.heading, y->T_map_base.heading, tolerance);
  const Eigen::MatrixXd P = a.slam().filter().covariance(), Q = b.slam().filter().covariance();
  ASSERT_EQ(P.rows(), Q.rows());
  EXPECT_LE((P - Q).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_EQ(a.slam().labels(), b.slam().labels());
}

TEST(LandmarkTimeline, OutOfOrderGivesWhatInOrderGives) {
  const Drive drawn = drive(1);
  LandmarkTimeline in_order = timelineOf(drawn), mixed = timelineOf(drawn);
  run(in_order, drawn, {0});
  run(mixed, drawn, {0.02, 0.7, 0.0, 0.34, 0.9, 0.12, 0.5});
  expectSame(in_order, mixed, 0);
}

TEST(LandmarkTimeline, LateSightingsAreAsGoodAsPromptOnes) {
  double prompt = 0, late = 0;
  for (int seed = 0; seed < 5; ++seed) {
    const Drive drawn = drive(seed);
    LandmarkTimeline a = timelineOf(drawn), b = timelineOf(drawn);
    prompt += run(a, drawn, {0}), late += run(b, drawn, {0.1});
  }
  EXPECT_GT(prompt / 5, 0.01);
  EXPECT_LT(late, 1.05 * prompt);
}

TEST(LandmarkTimeline, TellsOfEachMomentOnce) {
  const Drive drawn = drive(1);
  LandmarkTimeline timeline = timelineOf(drawn, 60);
  for (const auto& [stamp, pose] : drawn.odometry) timeline.odometry(stamp, pose);
  std::vector<int> order(drawn.looks.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  for (const int i : order) {
    ASSERT_EQ(timeline.see(drawn.looks[i].stamp, drawn.looks[i].sightings), Arrival::taken);
    ASSERT_EQ(timeline.applied().size(), 1u);
    EXPECT_EQ(timeline.applied()[0].stamp, drawn.looks[i].stamp);
    EXPECT_EQ(timeline.applied()[0].report.keys.size(), drawn.looks[i].sightings.size());
  }
  timeline.odometry(drawn.odometry.back().first + 1, drawn.odometry.back().second);
  EXPECT_TRUE(timeline.applied().empty());
}

TEST(LandmarkTimeline, TwoThatTellOfOneMomentAreBothHeard) {
  const Drive drawn = drive(2);
  LandmarkTimeline timeline = timelineOf(drawn);
  run(timeline, drawn, {0});
  const Look& last = drawn.looks.back();
  std::vector<LabelledSighting> other = last.sightings;
  other.pop_back();
  EXPECT_EQ(timeline.see(last.stamp, other), Arrival::taken);
  EXPECT_EQ(timeline.see(last.stamp, other), Arrival::duplicate);
}

TEST(LandmarkTimeline, TellsDuplicatesHoweverOldTheyAre) {
  const Drive drawn = drive(2);
  LandmarkTimeline timeline = timelineOf(drawn), other = timelineOf(drawn);
  run(timeline, drawn, {0});
  run(other, drawn, {0});
  for (const Look& look : drawn.looks) {
    const Arrival arrival = timeline.see(look.stamp, look.sightings);
    EXPECT_TRUE(arrival == Arrival::duplicate || arrival == Arrival::too_late) << look.stamp;
    if (look.stamp < drawn.looks.back().stamp - 0.99) continue;
    EXPECT_EQ(arrival, Arrival::duplicate) << look.stamp;
  }
  expectSame(timeline, other, 0);
  const Look& last = drawn.looks.back();
  EXPECT_EQ(timeline.see(last.stamp, last.sightings, {{0, 0}, 1}), Arrival::taken);  // another sensor
}

TEST(LandmarkTimeline, RefusesWhatIsTooLate) {
  const Drive drawn = drive(3);
  LandmarkTimeline timeline = timelineOf(drawn, 0.5);
  EXPECT_EQ(timeline.see(10, {}), Arrival::waiting);
  for (int i = 0; i <= 100; ++i) timeline.odometry(drawn.odometry[i].first, drawn.odometry[i].second);
  EXPECT_EQ(timeline.see(9.9, drawn.looks[0].sightings), Arrival::too_late);
  EXPECT_EQ(timeline.see(11.49, drawn.looks[0].sightings), Arrival::too_late);
  EXPECT_EQ(timeline.see(11.51, {}), Arrival::taken);
}

TEST(LandmarkTimeline, SightingsAheadOfOdometryWait) {
  const Drive drawn = drive(4);
  LandmarkTimeline ahead = timelineOf(drawn), in_order = timelineOf(drawn);
  run(in_order, drawn, {0});
  EXPECT_FALSE(ahead.now());
  size_t look = 0;
  for (const auto& [stamp, pose] : drawn.odometry) {
    for (; look < drawn.looks.size() && drawn.looks[look].stamp < stamp + 0.2; ++look) {
      EXPECT_EQ(ahead.see(drawn.looks[look].stamp, drawn.looks[look].sightings), Arrival::waiting);
      EXPECT_EQ(ahead.see(drawn.looks[look].stamp, drawn.looks[look].sightings), Arrival::duplicate);
    }
    const size_t waiting = ahead.waiting();
    ahead.odometry(stamp, pose);
    EXPECT_EQ(ahead.applied().size(), waiting - ahead.waiting());
  }
  EXPECT_EQ(ahead.applied().back().stamp, drawn.looks.back().stamp);
  EXPECT_EQ(ahead.applied().back().report.known, 6);
  expectSame(ahead, in_order, 0);
}

TEST(LandmarkTimeline, MapToOdomChangesWithSightingsOnly) {
  const Drive drawn = drive(5);
  LandmarkTimeline timeline = timelineOf(drawn);
  const auto offset = [&] { return timeline.now()->T_map_odom; };
  const auto apart = [](const Pose2& a, const Pose2& b) {
    return (a.position - b.position).norm() + std::abs(wrapped(a.heading - b.heading));
  };
  timeline.odometry(drawn.odometry[0].first, drawn.odometry[0].second);
  EXPECT_LT(apart(offset(), kStart * drawn.odometry[0].second.inverse()), 1e-12);
  for (int i = 1; i <= 500; ++i) {
    const Pose2 before = offset();
    timeline.odometry(drawn.odometry[i].first, drawn.odometry[i].second);
    EXPECT_LT(apart(offset(), before), 1e-9) << i;
    const auto now = timeline.now();
    EXPECT_LT(apart(now->T_map_odom * drawn.odometry[i].second, now->T_map_base), 1e-9);
    if (i != 50) continue;
    timeline.see(drawn.looks[9].stamp, drawn.looks[9].sightings);
    EXPECT_GT(apart(offset(), before), 1e-5);
  }
}

TEST(LandmarkTimeline, AddsTheClocksOffset) {
  Drive drawn = drive(6);
  LandmarkTimeline right = timelineOf(drawn), corrected = timelineOf(drawn, 1.0, 0.25);
  run(right, drawn, {0});
  for (Look& look : drawn.looks) look.stamp -= 0.25;
  run(corrected, drawn, {0.25});
  expectSame(right, corrected, 1e-9);
}

TEST(LandmarkTimeline, NamesAFieldThatIsOutOfRange) {
  const auto refused = [](const LandmarkTimelineParams& params) {
    return refusal<std::invalid_argument>([&] { params.validate(); });
  };
  LandmarkTimelineParams params;
  params.lag = 0;
  EXPECT_EQ(refused(params).find("lag is "), 0u);
  params = {};
  params.clock_offset = 11;
  EXPECT_EQ(refused(params).find("clock_offset is "), 0u);
  params = {};
  params.odometry.way_by_way = -1;
  EXPECT_EQ(refused(params).find("way_by_way is "), 0u);
}

}  // namespace
}  // namespace sextant
