// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_timeline.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

const Pose2 kStart{{2, 1}, 0.4};

struct Scan {
  double stamp;
  std::vector<LabelledObservation> observations;
};

/// A round trip at 0.5 m/s and 1 rad/s among six landmarks with ids; odometry has its own origin.
struct Drive {
  std::vector<std::pair<double, Pose2>> odometry, truth;  // stamp, pose
  std::vector<Scan> scans;
  std::vector<Landmark2D> landmarks;
  std::vector<LandmarkLabel> labels;
};

constexpr double kTick = 0.02;
constexpr int kTicks = 1000;

Drive drive(int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  Drive drawn;
  for (int i = 0; i < 6; ++i) {
    drawn.landmarks.push_back({{3 * std::cos(i) + 1, 3 * std::sin(i) + 1}, {}});
    drawn.labels.push_back({"tag", i});
  }
  Pose2 robot = kStart, wheels{{-7, 3}, 2};
  for (int i = 0; i <= kTicks; ++i) {
    const Pose2 motion{{0.5 * kTick, 0}, 1.0 * kTick};
    if (i > 0) robot = robot * motion;
    if (i > 0)
      wheels =
          wheels * Pose2{motion.position * (1 + 0.1 * noise(random)), motion.heading + 0.004 * noise(random)};
    drawn.truth.emplace_back(10 + i * kTick, robot);
    drawn.odometry.emplace_back(10 + i * kTick, wheels);
    if (i % 5) continue;
    drawn.scans.push_back({10 + i * kTick, {}});
    for (size_t k = 0; k < drawn.landmarks.size(); ++k) {
      const Vector2d at = toRobotFrame(robot, drawn.landmarks[k]).position;
      const Vector2d seen = at + 0.1 * Vector2d{noise(random), noise(random)};
      drawn.scans.back().observations.push_back({drawn.labels[k], {seen, {}, 0.01 * Matrix3d::Identity()}});
    }
  }
  return drawn;
}

LandmarkSlam slamOf(const Drive& drive) {
  LandmarkSlam slam({}, kStart, 1e-4 * Matrix3d::Identity());
  const auto size = static_cast<Eigen::Index>(3 + 2 * drive.landmarks.size());
  slam.setMap(kStart, drive.landmarks, drive.labels, 1e-4 * Eigen::MatrixXd::Identity(size, size));
  return slam;
}

LandmarkTimeline timelineOf(const Drive& drive, double lag = 1.0, double clock_offset = 0.0) {
  LandmarkTimelineParams params;
  params.lag = lag;
  params.clock_offset = clock_offset;
  return {params, slamOf(drive)};
}

/// All odometry, and each scan with this delay. @returns root of the mean squared error of the position
double run(LandmarkTimeline& timeline, const Drive& drive, const std::vector<double>& delays) {
  std::vector<std::pair<double, size_t>> arrivals;
  for (size_t k = 0; k < drive.scans.size(); ++k)
    arrivals.emplace_back(drive.scans[k].stamp + delays[k % delays.size()], k);
  std::stable_sort(arrivals.begin(), arrivals.end());
  double squares = 0;
  auto next = arrivals.begin();
  for (size_t i = 0; i < drive.odometry.size(); ++i) {
    EXPECT_TRUE(timeline.odometry(drive.odometry[i].first, drive.odometry[i].second));
    for (; next != arrivals.end() && next->first < drive.odometry[i].first + kTick / 2; ++next)
      EXPECT_EQ(timeline.observe(drive.scans[next->second].stamp, drive.scans[next->second].observations),
                Arrival::applied);
    squares += (timeline.now()->T_map_base.position - drive.truth[i].second.position).squaredNorm();
  }
  for (; next != arrivals.end(); ++next)
    timeline.observe(drive.scans[next->second].stamp, drive.scans[next->second].observations);
  return std::sqrt(squares / drive.odometry.size());
}

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

TEST(LandmarkTimeline, TheOrderOfArrivalDoesNotMatter) {
  const Drive drawn = drive(1);
  LandmarkTimeline in_order = timelineOf(drawn), mixed = timelineOf(drawn);
  run(in_order, drawn, {0});
  run(mixed, drawn, {0.02, 0.7, 0.0, 0.34, 0.9, 0.12, 0.5});
  expectSame(in_order, mixed, 0);
}

TEST(LandmarkTimeline, LateObservationsAreAsAccurateAsPromptOnes) {
  double prompt = 0, late = 0;
  for (int seed = 0; seed < 5; ++seed) {
    const Drive drawn = drive(seed);
    LandmarkTimeline a = timelineOf(drawn), b = timelineOf(drawn);
    prompt += run(a, drawn, {0}), late += run(b, drawn, {0.1});
  }
  EXPECT_GT(prompt / 5, 0.01);
  EXPECT_LT(late, 1.05 * prompt);
}

TEST(LandmarkTimeline, ReportsEachScanOnce) {
  const Drive drawn = drive(1);
  LandmarkTimeline timeline = timelineOf(drawn, 60);
  for (const auto& [stamp, pose] : drawn.odometry) timeline.odometry(stamp, pose);
  std::vector<int> order(drawn.scans.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  for (const int i : order) {
    ASSERT_EQ(timeline.observe(drawn.scans[i].stamp, drawn.scans[i].observations), Arrival::applied);
    ASSERT_EQ(timeline.applied().size(), 1u);
    EXPECT_EQ(timeline.applied()[0].stamp, drawn.scans[i].stamp);
    EXPECT_EQ(timeline.applied()[0].report.keys.size(), drawn.scans[i].observations.size());
  }
  timeline.odometry(drawn.odometry.back().first + 1, drawn.odometry.back().second);
  EXPECT_TRUE(timeline.applied().empty());
}

TEST(LandmarkTimeline, TwoScansOfOneStampAreBothApplied) {
  const Drive drawn = drive(2);
  LandmarkTimeline timeline = timelineOf(drawn);
  run(timeline, drawn, {0});
  const Scan& last = drawn.scans.back();
  std::vector<LabelledObservation> other = last.observations;
  other.pop_back();
  EXPECT_EQ(timeline.observe(last.stamp, other), Arrival::applied);
  EXPECT_EQ(timeline.observe(last.stamp, other), Arrival::duplicate);
}

TEST(LandmarkTimeline, RecognizesDuplicatesOfAnyAge) {
  const Drive drawn = drive(2);
  LandmarkTimeline timeline = timelineOf(drawn), other = timelineOf(drawn);
  run(timeline, drawn, {0});
  run(other, drawn, {0});
  for (const Scan& scan : drawn.scans) {
    const Arrival arrival = timeline.observe(scan.stamp, scan.observations);
    EXPECT_TRUE(arrival == Arrival::duplicate || arrival == Arrival::too_late) << scan.stamp;
    if (scan.stamp < drawn.scans.back().stamp - 0.99) continue;
    EXPECT_EQ(arrival, Arrival::duplicate) << scan.stamp;
  }
  expectSame(timeline, other, 0);
  const Scan& last = drawn.scans.back();
  EXPECT_EQ(timeline.observe(last.stamp, last.observations, {{0, 0}, 1}),
            Arrival::applied);  // another sensor
}

TEST(LandmarkTimeline, RefusesLateScans) {
  const Drive drawn = drive(3);
  LandmarkTimeline timeline = timelineOf(drawn, 0.5);
  EXPECT_EQ(timeline.observe(10, {}), Arrival::waiting);
  for (int i = 0; i <= 100; ++i) timeline.odometry(drawn.odometry[i].first, drawn.odometry[i].second);
  EXPECT_EQ(timeline.observe(9.9, drawn.scans[0].observations), Arrival::too_late);
  EXPECT_EQ(timeline.observe(11.49, drawn.scans[0].observations), Arrival::too_late);
  EXPECT_EQ(timeline.observe(11.51, {}), Arrival::applied);
}

TEST(LandmarkTimeline, ObservationsAheadOfOdometryWait) {
  const Drive drawn = drive(4);
  LandmarkTimeline ahead = timelineOf(drawn), in_order = timelineOf(drawn);
  run(in_order, drawn, {0});
  EXPECT_FALSE(ahead.now());
  size_t scan = 0;
  for (const auto& [stamp, pose] : drawn.odometry) {
    for (; scan < drawn.scans.size() && drawn.scans[scan].stamp < stamp + 0.2; ++scan) {
      EXPECT_EQ(ahead.observe(drawn.scans[scan].stamp, drawn.scans[scan].observations), Arrival::waiting);
      EXPECT_EQ(ahead.observe(drawn.scans[scan].stamp, drawn.scans[scan].observations), Arrival::duplicate);
    }
    const size_t waiting = ahead.waiting();
    ahead.odometry(stamp, pose);
    EXPECT_EQ(ahead.applied().size(), waiting - ahead.waiting());
  }
  EXPECT_EQ(ahead.applied().back().stamp, drawn.scans.back().stamp);
  EXPECT_EQ(ahead.applied().back().report.associated, 6);
  expectSame(ahead, in_order, 0);
}

TEST(LandmarkTimeline, MapToOdomChangesWithObservationsOnly) {
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
    timeline.observe(drawn.scans[9].stamp, drawn.scans[9].observations);
    EXPECT_GT(apart(offset(), before), 1e-5);
  }
}

TEST(LandmarkTimeline, AddsTheClockOffset) {
  Drive drawn = drive(6);
  LandmarkTimeline right = timelineOf(drawn), corrected = timelineOf(drawn, 1.0, 0.25);
  run(right, drawn, {0});
  for (Scan& scan : drawn.scans) scan.stamp -= 0.25;
  run(corrected, drawn, {0.25});
  expectSame(right, corrected, 1e-9);
}

TEST(LandmarkTimeline, NamesAFieldThatIsOutOfRange) {
  const auto refused = [](const LandmarkTimelineParams& params) {
    return refusal<std::invalid_argument>([&] { validate(params); });
  };
  LandmarkTimelineParams params;
  params.lag = 0;
  EXPECT_EQ(refused(params).find("lag is "), 0u);
  params = {};
  params.clock_offset = 11;
  EXPECT_EQ(refused(params).find("clock_offset is "), 0u);
  params = {};
  params.odometry.translation_from_translation = -1;
  EXPECT_EQ(refused(params).find("translation_from_translation is "), 0u);
}

// ---- pauses, jumps, restarts, poses that are set

TEST(LandmarkTimeline, MotionDuringAPauseOfOdometryIsUsed) {
  const LandmarkSlam slam({}, Pose2{}, 1e-4 * Matrix3d::Identity());
  LandmarkTimeline timeline({}, slam);
  for (int i = 0; i <= 100; ++i) timeline.odometry(10 + i * kTick, {{0.01 * i, 0}, 0});
  EXPECT_EQ(timeline.observe(11.9, {}), Arrival::applied);
  timeline.odometry(20, {{3, 0}, 0});
  EXPECT_NEAR(timeline.now()->T_map_base.position.x(), 3, 1e-9);
  EXPECT_NEAR(timeline.now()->covariance(0, 0), 1e-4 + 3 * 0.03 * 0.03,
              1e-6);  // 3 m, translation_from_translation
  timeline.odometry(30, {{4, 0}, 0});
  EXPECT_NEAR(timeline.now()->T_map_base.position.x(), 4, 1e-9);
}

TEST(LandmarkTimeline, ARestartKeepsTheMap) {
  const Drive drawn = drive(7);
  LandmarkTimeline timeline = timelineOf(drawn);
  run(timeline, drawn, {0});
  const Eigen::MatrixXd covariance = timeline.slam().filter().covariance();
  const Pose2 pose = timeline.slam().filter().pose();
  timeline.restart();
  EXPECT_FALSE(timeline.now());
  EXPECT_TRUE(timeline.odometry(1, {{100, 0}, 0}));  // another clock, another origin
  EXPECT_EQ(timeline.slam().filter().covariance(), covariance);
  EXPECT_LT((timeline.now()->T_map_base.position - pose.position).norm(), 1e-12);
  timeline.odometry(2, {{101, 0}, 0});
  EXPECT_LT((timeline.now()->T_map_base.position - pose * Vector2d(1, 0)).norm(), 1e-12);
  EXPECT_EQ(timeline.observe(1.5, {}), Arrival::applied);
}

TEST(LandmarkTimeline, AJumpOfOdometryRestartsItAndTheRobotIsLost) {
  const Drive drawn = drive(9);
  LandmarkTimeline timeline = timelineOf(drawn);
  run(timeline, drawn, {0});
  const double last = drawn.odometry.back().first;
  const Pose2 fast = drawn.odometry.back().second * Pose2{{0.9, 0}, 0};
  EXPECT_TRUE(timeline.odometry(last + 0.02, fast));
  EXPECT_EQ(timeline.jumps(), 0);
  EXPECT_TRUE(timeline.odometry(last + 0.07, fast * Pose2{{1.1, 0}, 0}));  // 22 m/s
  EXPECT_EQ(timeline.jumps(), 1);
  EXPECT_TRUE(timeline.slam().isLost());
  EXPECT_EQ(timeline.slam().labels().size(), 6u);
  EXPECT_EQ(timeline.observe(last + 0.05, {}), Arrival::too_late);
  EXPECT_TRUE(timeline.odometry(last + 10, fast * Pose2{{30, 0}, 0}));  // a pause
  EXPECT_EQ(timeline.jumps(), 1);
}

TEST(LandmarkTimeline, DropsTheNewestOfTooManyWaitingScans) {
  const Drive drawn = drive(9);
  LandmarkTimeline timeline = timelineOf(drawn);
  timeline.odometry(drawn.odometry[0].first, drawn.odometry[0].second);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(timeline.observe(1000 + i, {}), Arrival::waiting);
  EXPECT_EQ(timeline.waiting(), 100u);
  const Scan& soon = drawn.scans[2];
  EXPECT_EQ(timeline.observe(soon.stamp, soon.observations), Arrival::waiting);
  for (const auto& [stamp, pose] : drawn.odometry)
    if (stamp < soon.stamp + 0.05) timeline.odometry(stamp, pose);
  EXPECT_EQ(timeline.waiting(), 99u);
}

TEST(LandmarkTimeline, RefusesScansWithTooManyObservations) {
  const Drive drawn = drive(9);
  LandmarkTimeline timeline = timelineOf(drawn);
  timeline.odometry(10, {});
  std::vector<LabelledObservation> many(100, drawn.scans[0].observations.at(0));
  EXPECT_EQ(timeline.observe(10, many), Arrival::applied);
  many.push_back(many[0]);
  EXPECT_EQ(timeline.observe(10, many), Arrival::too_large);
  EXPECT_TRUE(timeline.applied().empty());
}

TEST(LandmarkTimeline, AChangeIsAppliedAtTheNewestOdometry) {
  const Drive drawn = drive(8);
  LandmarkTimeline timeline = timelineOf(drawn);
  for (int i = 0; i <= 500; ++i) timeline.odometry(drawn.odometry[i].first, drawn.odometry[i].second);
  EXPECT_EQ(timeline.observe(20.3, drawn.scans[0].observations), Arrival::waiting);
  const Pose2 elsewhere{{-4, 5}, 3};
  timeline.change([&](LandmarkSlam& slam) { slam.setPose(elsewhere, 0.01 * Matrix3d::Identity()); });
  EXPECT_LT((timeline.now()->T_map_base.position - elsewhere.position).norm(), 1e-12);
  EXPECT_LT((timeline.now()->covariance - 0.01 * Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_EQ(timeline.slam().labels().size(), 6u);
  EXPECT_EQ(timeline.observe(19.9, drawn.scans[0].observations), Arrival::too_late);
  timeline.odometry(20.5, drawn.odometry[500].second * Pose2{{1, 0}, 0});
  EXPECT_LT((timeline.now()->T_map_base.position - elsewhere * Vector2d(1, 0)).norm(), 1e-9);
}

// ---- places

const Matrix3d kRough = Eigen::Vector3d(0.25, 0.25, 0.04).asDiagonal();
const std::vector<PossiblePose> kElsewhere{{{{30, 0}, 0}, kRough, 0.98}};

/// A drive of ten seconds with odometry, and with all scans or none.
LandmarkTimeline drivenTimeline(const Drive& drawn, bool with_scans) {
  LandmarkTimeline timeline = timelineOf(drawn);
  for (int i = 0; i <= 500; ++i) timeline.odometry(drawn.odometry[i].first, drawn.odometry[i].second);
  for (size_t i = 91; with_scans && i <= 100; ++i)
    timeline.observe(drawn.scans[i].stamp, drawn.scans[i].observations);
  return timeline;
}

PlaceUse useOf(LandmarkTimeline& timeline, double stamp, const std::vector<PossiblePose>& poses) {
  EXPECT_EQ(timeline.observePlaces(stamp, poses), Arrival::applied);
  return timeline.applied().front().places.value();
}

TEST(LandmarkTimeline, PlacesDoNotChangeAPoseThatLandmarksConfirm) {
  const Drive drawn = drive(2);
  LandmarkTimeline timeline = drivenTimeline(drawn, true);
  for (size_t i = 101; i < 150; ++i) {
    for (size_t k = 5 * i - 4; k <= 5 * i; ++k)
      timeline.odometry(drawn.odometry[k].first, drawn.odometry[k].second);
    timeline.observe(drawn.scans[i].stamp, drawn.scans[i].observations);
    EXPECT_EQ(useOf(timeline, drawn.scans[i].stamp, kElsewhere), PlaceUse::contradicts);
    EXPECT_LT((timeline.now()->T_map_base.position - drawn.truth[5 * i].second.position).norm(), 0.3);
  }
}

TEST(LandmarkTimeline, APlaceIsThatOfTheImageNotOfItsArrival) {
  const Drive drawn = drive(4);
  LandmarkTimeline timeline = drivenTimeline(drawn, false);
  timeline.change([](LandmarkSlam& slam) { slam.relocalize(); });
  for (int i = 501; i <= 540; ++i) timeline.odometry(drawn.odometry[i].first, drawn.odometry[i].second);
  const auto& [stamp, truth] = drawn.truth[510];
  EXPECT_EQ(useOf(timeline, stamp, {{truth, 1e-6 * kRough, 0.6}}), PlaceUse::relocalized);
  EXPECT_LT(difference(timeline.now()->T_map_base, drawn.truth[540].second).norm(), 0.1);
  EXPECT_GT((truth.position - drawn.truth[540].second.position).norm(), 0.2);
}

TEST(LandmarkTimeline, ScansAfterALateImageAreAppliedAfterIt) {
  const Drive drawn = drive(6);
  LandmarkTimeline in_order = drivenTimeline(drawn, true), late = drivenTimeline(drawn, true);
  const std::vector<PossiblePose> places{{drawn.truth[500].second, kRough, 0.9}};
  for (LandmarkTimeline* each : {&in_order, &late}) {
    for (int i = 501; i <= 510; ++i) each->odometry(drawn.odometry[i].first, drawn.odometry[i].second);
    if (each == &in_order) each->observePlaces(20.05, places);
    each->observe(drawn.scans[101].stamp, drawn.scans[101].observations);
    each->observe(drawn.scans[102].stamp, drawn.scans[102].observations);
    if (each == &late) each->observePlaces(20.05, places);
  }
  EXPECT_EQ(late.now()->T_map_base, in_order.now()->T_map_base);
  EXPECT_EQ(late.now()->covariance, in_order.now()->covariance);
}

TEST(LandmarkTimeline, UnknownPlacesAndOldImagesAreNotUsed) {
  LandmarkTimeline timeline = drivenTimeline(drive(5), false);
  timeline.change([](LandmarkSlam& slam) { slam.relocalize(); });
  const double now = timeline.now()->stamp;
  EXPECT_EQ(useOf(timeline, now, {}), PlaceUse::unused);
  EXPECT_EQ(useOf(timeline, now, {{{}, kRough, 0.4}}), PlaceUse::unused);
  EXPECT_EQ(timeline.observePlaces(3.0, kElsewhere), Arrival::too_late);
  EXPECT_TRUE(timeline.slam().isLost());
  EXPECT_EQ(timeline.observePlaces(now + 1.0, kElsewhere), Arrival::waiting);
  timeline.odometry(now + 2.0, {});
  EXPECT_EQ(timeline.applied().front().places, PlaceUse::relocalized);
}

}  // namespace
}  // namespace sextant
