// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_slam.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

const Matrix3d kStart = 1e-4 * Matrix3d::Identity();
const LandmarkLabel kRed{"red", {}}, kBlue{"blue", {}};

struct Thing {
  Landmark2D landmark;
  LandmarkLabel label;
};

Thing pillar(double x, double y, const LandmarkLabel& label = kRed) { return {{{x, y}, {}}, label}; }
Thing tag(int id, double x, double y, double heading) { return {{{x, y}, heading}, {"tag", id}}; }

LabelledObservation seen(const Pose2& robot, const Thing& thing, double sigma = 0.03) {
  const Landmark2D at = toRobotFrame(robot, thing.landmark);
  return {thing.label, {at.position, at.heading, sigma * sigma * Matrix3d::Identity()}};
}

std::vector<LabelledObservation> allSeen(const Pose2& robot, const std::vector<Thing>& things) {
  std::vector<LabelledObservation> all;
  for (const Thing& each : things) all.push_back(seen(robot, each));
  return all;
}

LandmarkSlamParams params() {
  LandmarkSlamParams params;
  params.sensor.field_of_view = 3.0;
  return params;
}

/// A robot at the origin and observations with this noise.
LandmarkSlam knowing(const std::vector<Thing>& things, const LandmarkSlamParams& params,
                     double sigma = 0.01) {
  LandmarkSlam slam(params, {}, kStart);
  std::vector<Landmark2D> landmarks;
  std::vector<LandmarkLabel> labels;
  Eigen::Index size = 3;
  for (const Thing& each : things) {
    landmarks.push_back(each.landmark);
    labels.push_back(each.label);
    size += each.landmark.dimension();
  }
  slam.setMap({}, landmarks, labels, sigma * sigma * MatrixXd::Identity(size, size));
  return slam;
}

void expectPose(const LandmarkSlam& slam, const Pose2& pose, double metres) {
  EXPECT_LT((slam.filter().pose().position - pose.position).norm(), metres);
  EXPECT_NEAR(wrapped(slam.filter().pose().heading - pose.heading), 0, metres);
}

TEST(LandmarkSlam, LandmarksOutsideTheViewOfAnotherSensorAreKept) {
  LandmarkSlamParams narrow = params();
  narrow.sensor.field_of_view = 1.2;
  const std::vector<Thing> ahead{pillar(2, 0.5), pillar(2, -0.5)}, behind{pillar(-2, 0.5), pillar(-2, -0.5)};
  std::vector<Thing> all = ahead;
  all.insert(all.end(), behind.begin(), behind.end());
  LandmarkSlam slam = knowing(all, narrow);
  for (int i = 0; i < 50; ++i)
    EXPECT_EQ(slam.observe(0.1 * i, allSeen({}, behind), {{0, 0}, M_PI}).removed, 0) << i;
  EXPECT_EQ(slam.labels().size(), 4u);
  EXPECT_FALSE(slam.isLost());
}

TEST(LandmarkSlam, AMissedMarkerIsKeptAndARelocatedOneIsRemoved) {
  const Thing moved = tag(1, 2, -0.5, M_PI), still = tag(2, 2, 0.5, M_PI);
  const std::vector<Thing> all{moved, still, tag(3, 3, 0, M_PI), tag(4, 3, 0.8, M_PI)};
  LandmarkSlam slam = knowing(all, params());
  for (int i = 0; i < 50; ++i) EXPECT_EQ(slam.observe(0.1 * i, allSeen({}, {still})).removed, 0) << i;
  for (int i = 0; i < 50; ++i) slam.observe(5 + 0.1 * i, allSeen({}, {}));
  EXPECT_EQ(slam.labels().size(), 4u);
  EXPECT_FALSE(slam.isLost());
  const std::vector<Thing> now{tag(1, 1.5, -0.5, M_PI), still};
  for (int i = 0; i < 50; ++i) slam.observe(10 + 0.1 * i, allSeen({}, now));
  ASSERT_EQ(slam.labels().size(), 4u);
  EXPECT_EQ(slam.labels().back(), moved.label);  // initialized again
  EXPECT_LT((slam.filter().landmarks().back().position - now[0].landmark.position).norm(), 0.05);
  EXPECT_FALSE(slam.isLost());
}

TEST(LandmarkSlam, ObservationsBecomeLandmarks) {
  LandmarkSlam slam(params(), {{1, 2}, 0.5}, kStart);
  const std::vector<Thing> things{pillar(3, 3), pillar(4, 2, kBlue), tag(7, 5, 4, 1)};
  LandmarkReport report;
  for (int i = 0; i < 3; ++i) {
    report = slam.observe(0.1 * i, allSeen({{1, 2}, 0.5}, things));
    EXPECT_EQ(report.tentative, 3);
    EXPECT_EQ(slam.candidates(), 3u);
  }
  report = slam.observe(0.4, allSeen({{1, 2}, 0.5}, things));
  EXPECT_EQ(report.initialized, 3);
  ASSERT_EQ(slam.labels().size(), 3u);
  EXPECT_EQ(slam.labels()[2], (LandmarkLabel{"tag", 7}));
  EXPECT_NEAR(*slam.filter().landmarks()[2].heading, 1, 1e-9);
  EXPECT_EQ(std::set<int>(slam.keys().begin(), slam.keys().end()).size(), 3u);
  report = slam.observe(0.5, allSeen({{1, 2}, 0.5}, things));
  EXPECT_EQ(report.associated, 3);
  EXPECT_EQ(report.nis_dof, 7);
  EXPECT_EQ(report.keys[1], slam.keys()[1]);
}

TEST(LandmarkSlam, DuplicatesAreMerged) {
  for (const size_t first : {0, 1}) {
    std::vector<Thing> things{pillar(2, 0), pillar(2.05, 0), pillar(2.05, 0, kBlue), pillar(2, 2)};
    std::rotate(things.begin(), things.begin() + first, things.begin() + 2);
    LandmarkSlamParams unclear = params();
    unclear.association.ambiguity_margin = 0;
    LandmarkSlam slam = knowing(things, unclear);
    const std::vector<int> keys = slam.keys();
    const LandmarkReport report = slam.observe(0, allSeen({}, {pillar(2.05, 0), things[3]}));
    EXPECT_EQ(report.associated, 2);
    EXPECT_EQ(report.merged, 1);
    EXPECT_EQ(slam.labels(), (std::vector<LandmarkLabel>{kRed, kBlue, kRed}));
    EXPECT_EQ(slam.keys(), (std::vector<int>{keys[0], keys[2], keys[3]}));
    EXPECT_EQ(report.keys[0], keys[0]);
    EXPECT_NEAR(slam.filter().landmarks()[0].position.x(), 2.025, 0.02);
  }
}

TEST(LandmarkSlam, ManyDuplicatesAreMergedAtOnce) {
  LandmarkSlamParams unclear = params();
  unclear.association.ambiguity_margin = 0;
  const std::vector<Thing> things{pillar(2, 0.02), pillar(2, 0.01), pillar(2, 0), pillar(2, -0.01)};
  for (size_t which = 0; which < things.size(); ++which) {
    LandmarkSlam slam = knowing(things, unclear);
    EXPECT_EQ(slam.observe(0, allSeen({}, {things[which]})).merged, 3) << which;
    EXPECT_EQ(slam.labels().size(), 1u);
  }
}

TEST(LandmarkSlam, UncertainDuplicatesAreNotMerged) {
  LandmarkSlam slam = knowing({pillar(2, 0), pillar(2, 0.35), pillar(2, 1.0)}, params());
  EXPECT_EQ(slam.observe(0, allSeen({}, {pillar(2, 0)})).merged, 0);
  LandmarkSlam unsure = knowing({pillar(2, 0), pillar(2, 0.2)}, params(), 0.1);
  EXPECT_EQ(unsure.observe(0, allSeen({}, {pillar(2, 0)})).merged, 0);
}

/// A moment with nothing but one landmark after another, which shows that the robot is where it should be.
int momentsUntilRemoved(LandmarkSlam& slam, const std::vector<Thing>& there, int most = 40) {
  for (int i = 1; i <= most; ++i)
    if (slam.observe(0.1 * i, allSeen({}, there)).removed) return i;
  return 0;
}

// From log odds 8 to -4 in steps of log(0.2 / 0.95). The missed landmark is next to an observed one.
TEST(LandmarkSlam, AMissedLandmarkIsRemoved) {
  LandmarkSlam slam = knowing({pillar(2, 0.5), pillar(2.5, -0.2), pillar(2, 2)}, params());
  EXPECT_EQ(momentsUntilRemoved(slam, {pillar(2, 0.5), pillar(2, 2)}),
            static_cast<int>(std::ceil(12 / std::log(0.95 / 0.2))));
  EXPECT_EQ(slam.labels().size(), 2u);
  EXPECT_EQ(momentsUntilRemoved(slam, {pillar(2, 0.5), pillar(2, 2)}), 0);
}

TEST(LandmarkSlam, ObservationsRestoreTheLogOdds) {
  const std::vector<Thing> both{pillar(2, 0.5), pillar(3, -1)};
  LandmarkSlam slam = knowing(both, params());
  for (int i = 0; i < 60; ++i) {  // three of four misses are outweighed: 3 x 1.56 against 2.77
    const bool is_seen = i % 3 == 0;
    slam.observe(0.1 * i, allSeen({}, is_seen ? both : std::vector<Thing>{both[0]}));
  }
  EXPECT_EQ(slam.labels().size(), 2u);
}

TEST(LandmarkSlam, OccludedLandmarksAndThoseOutOfViewAreKept) {
  const Thing near = pillar(1, 0);
  LandmarkSlam slam =
      knowing({near, pillar(3, 0.05), pillar(-2, 0), pillar(0, 20), pillar(6, 0.9)}, params());
  EXPECT_EQ(momentsUntilRemoved(slam, {near}), 0);
  EXPECT_EQ(slam.labels().size(), 5u);
}

TEST(LandmarkSlam, NothingIsRemovedWhileNothingIsObserved) {
  LandmarkSlam slam = knowing({pillar(2, 0)}, params());
  EXPECT_EQ(momentsUntilRemoved(slam, {}), 0);
  EXPECT_FALSE(slam.isLost());
}

TEST(LandmarkSlam, MeasuredIdsNeedNoAssociation) {
  const Thing near[] = {tag(1, 2, 0, 3), tag(2, 2, 0.05, 3)};
  LandmarkSlam slam = knowing({near[0], near[1]}, params());
  const LandmarkReport report = slam.observe(0, allSeen({}, {near[1], near[0]}));
  EXPECT_EQ(report.associated, 2);
  EXPECT_EQ(report.keys[0], slam.keys()[1]);
  EXPECT_EQ(report.merged, 0);
}

TEST(LandmarkSlam, AnIdOutsideOfItsGateIsRejected) {
  const std::vector<Thing> things{tag(1, 2, 0, 3), tag(2, 2, 1, 3)};
  LandmarkSlam slam = knowing(things, params());
  const Pose2 before = slam.filter().pose();
  for (const Thing& wrong : {tag(2, 3, -1, 3), tag(2, 2, 1, 1.5)}) {
    const LandmarkReport report = slam.observe(0, allSeen({}, {things[0], wrong}));
    EXPECT_EQ(report.associated, 1);
    EXPECT_EQ(report.rejected, 1);
    EXPECT_FALSE(report.keys[1]);
    EXPECT_EQ(report.tentative, 0);
  }
  EXPECT_EQ(slam.labels().size(), 2u);
  expectPose(slam, before, 1e-3);
}

// Two prints with the same id: either of them may be the landmark.
TEST(LandmarkSlam, AnIdObservedTwiceInOneScanInitializesNothing) {
  const Thing here = tag(1, 2, 0, 3), there = tag(1, 2, 1, 3), other = tag(2, 3, 0.5, 3);
  LandmarkSlam fresh(params(), {}, kStart);
  for (int i = 0; i < 10; ++i) fresh.observe(0.1 * i, allSeen({}, {here, there, other}));
  EXPECT_EQ(fresh.labels(), (std::vector<LandmarkLabel>{{"tag", 2}}));

  LandmarkSlam slam = knowing({here, other}, params());
  const LandmarkReport report = slam.observe(0, allSeen({}, {here, here, other}));
  EXPECT_EQ(report.associated, 2);
  EXPECT_EQ(report.ambiguous, 1);
  EXPECT_EQ(report.keys[0], slam.keys()[0]);
  EXPECT_FALSE(report.keys[1]);
}

// Otherwise each becomes a landmark again and again.
TEST(LandmarkSlam, ObservationsBeyondTheMaximumRangeAreAssociated) {
  for (const double range : {5.05, 9.0}) {
    LandmarkSlam slam = knowing({pillar(range, 0)}, params());
    EXPECT_EQ(slam.observe(0, allSeen({}, {pillar(range - 0.08, 0)})).associated, 1) << range;
  }
}

TEST(LandmarkSlam, AmbiguousObservationsChangeNothing) {
  LandmarkSlam slam = knowing({pillar(2, 0), pillar(2, 0.4)}, params());
  const MatrixXd before = slam.filter().covariance();
  for (int i = 0; i < 10; ++i) {
    const LandmarkReport report = slam.observe(0.1 * i, allSeen({}, {pillar(2, 0.2)}));
    EXPECT_EQ(report.ambiguous, 1);
    EXPECT_EQ(report.associated + report.tentative + report.initialized, 0);
  }
  EXPECT_EQ(slam.filter().covariance(), before);
  EXPECT_EQ(slam.candidates(), 0u);
}

TEST(LandmarkSlam, ObservationsThatCannotInitializeUpdateKnownLandmarksOnly) {
  LandmarkSlam slam = knowing({tag(1, 2, 0, 3)}, params());
  std::vector<LabelledObservation> both = allSeen({}, {tag(1, 2, 0, 3), tag(2, 2, 1, 3)});
  for (LabelledObservation& each : both) each.can_initialize = false;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(slam.observe(0.1 * i, both).associated, 1);
  EXPECT_EQ(slam.labels().size(), 1u);
  EXPECT_EQ(slam.candidates(), 0u);
}

TEST(LandmarkSlam, ReadOnlyKeepsItsLandmarks) {
  LandmarkSlamParams fixed = params();
  fixed.read_only = true;
  LandmarkSlam slam = knowing({pillar(2, 0), pillar(2, 2), pillar(2, 2.02)}, fixed);
  for (int i = 0; i < 30; ++i) {
    const LandmarkReport report = slam.observe(0.1 * i, allSeen({}, {pillar(2, 0), pillar(1, 1)}));
    EXPECT_EQ(report.associated, 1);
    EXPECT_EQ(report.initialized + report.merged + report.removed, 0);
  }
  EXPECT_EQ(slam.labels().size(), 3u);
}

TEST(LandmarkSlam, ACopyIsIndependent) {
  LandmarkSlam slam = knowing({pillar(2, 0), pillar(2, 2)}, params());
  LandmarkSlam copy({}, {}, kStart);
  copy = slam;
  EXPECT_EQ(copy.filter().covariance(), slam.filter().covariance());
  copy.relocalize();
  LandmarkSlam lost(copy);
  EXPECT_TRUE(lost.isLost());
  copy.setPose({{1, 1}, 1}, kStart);
  EXPECT_FALSE(copy.isLost());
  EXPECT_TRUE(lost.isLost());
  EXPECT_FALSE(slam.isLost());
  expectPose(slam, {}, 1e-12);
}

// ---- the robot is elsewhere than it thinks

// Put elsewhere, it drives on an arc, sees what is not where it should be, and finds itself again.
void expectFoundAgain(LandmarkSlam& slam, const std::vector<Thing>& things, Pose2 robot, int lost_after) {
  const Pose2 motion{{0.1, 0}, 0.05};
  const size_t known = slam.labels().size();
  bool was_lost = false;
  for (int i = 0; i < 60; ++i) {
    if (i > 0) robot = robot * motion, slam.predict({motion, 1e-6 * Matrix3d::Identity(), 0.1}, 0.1);
    const LandmarkReport report = slam.observe(0.1 * i, allSeen(robot, things));
    EXPECT_EQ(report.lost, slam.isLost()) << i;
    EXPECT_FALSE(i + 1 < lost_after && slam.isLost()) << i;
    was_lost = was_lost || slam.isLost();
  }
  EXPECT_TRUE(was_lost);
  EXPECT_FALSE(slam.isLost());
  EXPECT_EQ(slam.labels().size(), known);
  expectPose(slam, robot, 0.05);
}

TEST(LandmarkSlam, AKidnappedRobotIsRelocalizedByMarkers) {
  const std::vector<Thing> things{tag(1, 2, 0, 3), tag(2, 3, 1.5, -2), tag(3, 6, -2, 1), tag(4, 5, 3, 0)};
  LandmarkSlamParams impatient = params();
  impatient.lost_after = 4;
  LandmarkSlam slam = knowing(things, impatient);
  slam.observe(0, allSeen({}, things));
  expectFoundAgain(slam, things, {{3, 0.2}, 1.2}, 4);
}

TEST(LandmarkSlam, AKidnappedRobotIsRelocalizedByPillars) {
  const std::vector<Thing> things{pillar(2, 0),        pillar(4, 1.5, kBlue), pillar(6, -2),
                                  pillar(5, 3, kBlue), pillar(0, 3.3),        pillar(-2, 1, kBlue)};
  for (const bool read_only : {false, true}) {
    LandmarkSlamParams fixed = params();
    fixed.read_only = read_only;
    LandmarkSlam slam = knowing(things, fixed);
    slam.relocalize();
    EXPECT_TRUE(slam.isLost());
    expectFoundAgain(slam, things, {{3, 0.2}, 1.2}, 0);
  }
}

TEST(LandmarkSlam, ALostRobotIsRelocalizedAfterALongDriveWithoutLandmarks) {
  const std::vector<Thing> things{pillar(2, 0.5), pillar(2.5, -0.7, kBlue), pillar(3.5, 0.2),
                                  pillar(1.5, 1, kBlue)};
  for (const double distance : {10.0, 100.0, 1e4, 1e8}) {
    LandmarkSlam slam = knowing(things, params());
    slam.relocalize();
    slam.predict(noisyStep({{distance, 0}, 0}, {}), 1e9);  // the odometry of a robot that was carried back
    for (int i = 0; i < 10; ++i) slam.observe(1e9 + 0.1 * i, allSeen({}, things));
    EXPECT_FALSE(slam.isLost()) << distance;
    expectPose(slam, {}, 0.05);
  }
}

TEST(LandmarkSlam, ALostRobotIsRelocalizedAfterUselessObservations) {
  const std::vector<Thing> things{pillar(2, 0.5), pillar(2.5, -0.7, kBlue), pillar(3.5, 0.2),
                                  pillar(1.5, 1, kBlue)};
  for (const double sigma : {1.0, 10.0, 100.0, 1e4})
    for (const int useless : {1, 2, 5, 20}) {
      LandmarkSlam slam = knowing(things, params());
      slam.relocalize();
      for (int i = 0; i < useless; ++i) {
        std::vector<LabelledObservation> scan = allSeen({}, things);
        for (LabelledObservation& each : scan) each.observation.covariance *= std::pow(sigma / 0.03, 2);
        slam.observe(0.1 * i, scan);
      }
      for (int i = 0; i < 10; ++i) slam.observe(10 + 0.1 * i, allSeen({}, things));
      EXPECT_FALSE(slam.isLost()) << sigma << " " << useless;
      expectPose(slam, {}, 0.05);
    }
}

}  // namespace
}  // namespace sextant
