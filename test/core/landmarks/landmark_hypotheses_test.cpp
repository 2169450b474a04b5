// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_hypotheses.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

const LandmarkLabel kRed{"red", {}}, kBlue{"blue", {}};

LabelledObservation seen(const Pose2& robot, const Vector2d& landmark, const LandmarkLabel& label = kRed) {
  return {label, {robot.inverse() * landmark, {}, 1e-4 * Matrix3d::Identity()}};
}

const Vector2d kLeft(3, 0.5), kRight(3, -0.5), kBeacon(6, 3);

/// A robot whose heading is uncertain among two red landmarks and a blue one.
LandmarkHypotheses uncertain(int hypotheses, double heading_sigma = 0.3) {
  LandmarkSlamParams params;
  params.hypotheses = hypotheses;
  params.sensor.field_of_view = 6;
  params.sensor.max_range = 10;
  LandmarkSlam slam(params, {}, Matrix3d::Identity());
  MatrixXd covariance = 1e-4 * MatrixXd::Identity(9, 9);
  covariance(2, 2) = heading_sigma * heading_sigma;
  slam.setMap({}, {{kLeft, {}}, {kRight, {}}, {kBeacon, {}}}, {kRed, kRed, kBlue}, covariance);
  return LandmarkHypotheses(slam);
}

/// The true heading is such that the left landmark is seen where the right one is expected.
const Pose2 kTruth{{0, 0}, 2 * std::atan2(0.5, 3.0)};

TEST(LandmarkHypotheses, AnAmbiguousObservationStaysOpenUntilAnotherDecides) {
  LandmarkHypotheses all = uncertain(4);
  all.observe(0, {seen(kTruth, kLeft)});
  EXPECT_GT(all.size(), 1u);
  EXPECT_LT(all.probability(), 1);
  EXPECT_NEAR(all.best().filter().pose().heading, 0, 0.02);  // the nearer one is more likely
  all.observe(0.1, {seen(kTruth, kBeacon, kBlue)});
  EXPECT_EQ(all.size(), 1u);
  EXPECT_NEAR(all.probability(), 1, 1e-9);
  EXPECT_NEAR(all.best().filter().pose().heading, kTruth.heading, 0.02);
}

TEST(LandmarkHypotheses, WithOneAnAmbiguousObservationIsNotUsed) {
  LandmarkHypotheses all = uncertain(1);
  const LandmarkReport report = all.observe(0, {seen(kTruth, kLeft)});
  EXPECT_EQ(all.size(), 1u);
  EXPECT_EQ(report.ambiguous, 1);
  EXPECT_EQ(all.best().filter().pose().heading, 0);
}

TEST(LandmarkHypotheses, TheCovarianceCoversTheOthers) {
  LandmarkHypotheses all = uncertain(4);
  all.observe(0, {seen(kTruth, kLeft)});
  const PoseEstimate2D published = all.predictPose({});
  const double own = all.best().filter().covariance({})(2, 2);
  EXPECT_GT(published.covariance(2, 2), 4 * own);
  EXPECT_GT(published.covariance(2, 2), 0.1 * (1 - all.probability()) * kTruth.heading * kTruth.heading);
}

TEST(LandmarkHypotheses, TheirNumberIsBounded) {
  for (const int most : {2, 3}) {
    LandmarkHypotheses all = uncertain(most, 1.0);
    for (int i = 0; i < 5; ++i) {
      all.predict({{{0.1, 0}, 0.3}, 0.1 * Matrix3d::Identity(), 0.1, 0.3});
      all.observe(i, {seen({{0.1 * i, 0}, 0.3 * i}, kLeft)});
      EXPECT_LE(all.size(), static_cast<size_t>(most));
    }
  }
}

TEST(LandmarkHypotheses, EmptyScansDecideNothing) {
  LandmarkHypotheses all = uncertain(4);
  all.observe(0, {seen(kTruth, kLeft)});
  const size_t before = all.size();
  all.observe(0.1, {});
  const double probability = all.probability();
  for (int i = 2; i < 30; ++i) all.observe(0.1 * i, {});
  EXPECT_EQ(all.size(), before);
  EXPECT_NEAR(all.probability(), probability, 1e-9);
}

TEST(LandmarkHypotheses, SettlingKeepsTheBest) {
  LandmarkHypotheses all = uncertain(4);
  all.observe(0, {seen(kTruth, kLeft)});
  const Pose2 best = all.best().filter().pose();
  EXPECT_EQ(all.settled().filter().pose(), best);
  EXPECT_EQ(all.size(), 1u);
  EXPECT_EQ(all.probability(), 1);
}

// After a drive without landmarks the robot is 0.6 m from where odometry has it, ten of its deviations.
TEST(LandmarkHypotheses, ASlipIsRecognizedByTheNextLandmarks) {
  for (const int most : {1, 4}) {
    LandmarkHypotheses all = uncertain(most, 0.01);
    all.predict({{{1, 0}, 0}, 1e-4 * Matrix3d::Identity(), 1});
    const Pose2 truth{{1.6, 0}, 0};
    for (int i = 0; i < 10; ++i) all.observe(0.1 * i, {seen(truth, kLeft), seen(truth, kBeacon, kBlue)});
    const double off = (all.best().filter().pose().position - truth.position).norm();
    if (most > 1) {
      EXPECT_LT(off, 0.05);
      EXPECT_EQ(all.best().labels().size(), 3u);
    } else {
      EXPECT_GT(off, 0.3);
    }
  }
}

/// Two rooms 20 m apart: a red and a blue landmark in the first, two red ones in the second.
LandmarkHypotheses lostAmongRooms() {
  LandmarkSlamParams params;
  params.sensor.field_of_view = 6;
  LandmarkSlam slam(params, {}, Matrix3d::Identity());
  const std::vector<Landmark2D> landmarks{{{2, 0}, {}}, {{2, 1}, {}}, {{22, 0}, {}}, {{22, 1}, {}}};
  slam.setMap({}, landmarks, {kRed, kBlue, kRed, kRed}, 1e-4 * MatrixXd::Identity(11, 11));
  slam.relocalize();
  return LandmarkHypotheses(slam);
}

const Matrix3d kRough = Eigen::Vector3d(0.25, 0.25, 0.04).asDiagonal();
const PossiblePose kFirstRoom{{{0.3, 0.2}, 0.1}, kRough, 0.7}, kSecondRoom{{{20.3, -0.2}, 0.1}, kRough, 0.3};

TEST(LandmarkHypotheses, LandmarksDecideAtWhichPlaceALostRobotIs) {
  LandmarkHypotheses all = lostAmongRooms();
  ASSERT_TRUE(all.best().isLost());
  EXPECT_EQ(all.observePlaces({kSecondRoom, kFirstRoom}), PlaceUse::relocalized);
  EXPECT_FALSE(all.best().isLost());
  EXPECT_FALSE(all.isConfirmed());
  EXPECT_NEAR(all.probability(), 0.7, 1e-9);
  EXPECT_EQ(all.best().filter().pose(), kFirstRoom.T_map_base);  // the more probable one
  const Pose2 truth{{20, 0}, 0};
  for (int i = 0; i < 5; ++i) all.observe(0.1 * i, {seen(truth, {22, 0}), seen(truth, {22, 1})});
  EXPECT_TRUE(all.isConfirmed());
  EXPECT_GT(all.probability(), 0.999);
  EXPECT_LT(difference(all.best().filter().pose(), truth).norm(), 0.05);
}

TEST(LandmarkHypotheses, ManyImprobablePlacesAreTogetherAPose) {
  LandmarkHypotheses all = lostAmongRooms();
  std::vector<PossiblePose> many;
  for (int i = 0; i < 30; ++i) many.push_back({{{10.0 * i, 0}, 0}, kRough, 0.03});
  EXPECT_EQ(all.observePlaces(many), PlaceUse::relocalized);
  EXPECT_EQ(all.size(), 8u);
}

TEST(LandmarkHypotheses, TheCovarianceCoversAllPlaces) {
  LandmarkHypotheses all = lostAmongRooms();
  all.observePlaces({kFirstRoom, kSecondRoom});
  EXPECT_NEAR(all.predictPose({}).covariance(0, 0), 0.25 + 0.3 * 20 * 20, 1e-6);
}

TEST(LandmarkHypotheses, TheCovarianceCoversAHalfTurnToEitherSide) {
  LandmarkHypotheses all = lostAmongRooms();
  all.observePlaces({{{}, kRough, 0.6}, {{{20, 0}, M_PI}, kRough, 0.4}});
  const Matrix3d covariance = all.predictPose({}).covariance;
  for (const double turn : {M_PI, -M_PI}) {
    const Eigen::Vector3d off(20, 0, turn);
    EXPECT_LT(off.dot(covariance.inverse() * off), 2 / 0.4);
  }
}

TEST(LandmarkHypotheses, WhatTheRobotMappedAtAWrongPoseIsNotKept) {
  LandmarkHypotheses all = lostAmongRooms();
  all.observePlaces({{{{8, 8}, 0}, kRough, 0.9}});
  for (int i = 0; i < 30; ++i)
    all.observe(0.1 * i, {seen({{20, 0}, 0}, {22, 0}), seen({{20, 0}, 0}, {22, 1})});
  EXPECT_EQ(all.best().labels().size(), 6u);
  for (int i = 0; i < 5; ++i) all.observePlaces({{kSecondRoom.T_map_base, kRough, 0.9}});
  EXPECT_NEAR(all.best().filter().pose().position.x(), 20.3, 1e-6);
  EXPECT_EQ(all.best().labels().size(), 4u);
}

/// A robot in the first room whose landmarks it has just observed.
LandmarkHypotheses inFirstRoom() {
  LandmarkHypotheses all = lostAmongRooms();
  all.observePlaces({{{}, kRough, 1}});
  for (int i = 0; i < 3; ++i) all.observe(0.1 * i, {seen({}, {2, 0}), seen({}, {2, 1}, kBlue)});
  return all;
}

double farOff(const LandmarkHypotheses& all) { return all.best().filter().pose().position.norm(); }

const PossiblePose kElsewhere{{{20, 0}, 0}, kRough, 0.9};

TEST(LandmarkHypotheses, TheCovarianceDoesNotCoverAnImprobablePlace) {
  LandmarkHypotheses all = inFirstRoom();
  all.observePlaces({{{}, kRough, 0.5}, {{{20, 0}, 0}, kRough, 0.3}});
  EXPECT_EQ(all.size(), 2u);
  const double improbable = 1 - all.probability();  // of a place 20 m away
  EXPECT_GT(improbable, 1e-5);
  EXPECT_LT(all.predictPose({}).covariance(0, 0), improbable * 20 * 20);
}

TEST(LandmarkHypotheses, ImagesOfAnotherPlaceBecomeAHypothesisThatLandmarksRefute) {
  LandmarkHypotheses all = inFirstRoom();
  ASSERT_TRUE(all.isConfirmed());
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(all.observePlaces({kElsewhere}), PlaceUse::contradicts);
    EXPECT_EQ(all.size(), 2u);
    all.observe(1 + 0.1 * i, {seen({}, {2, 0}), seen({}, {2, 1}, kBlue)});
    EXPECT_EQ(all.size(), 1u);
    EXPECT_LT(farOff(all), 0.1);
  }
}

TEST(LandmarkHypotheses, ImagesOfAnotherPlaceMoveARobotThatObservesNothing) {
  LandmarkHypotheses all = inFirstRoom();
  EXPECT_EQ(all.observePlaces({{{}, kRough, 0.9}}), PlaceUse::agrees);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(all.observePlaces({kElsewhere}), PlaceUse::contradicts);
  EXPECT_LT(farOff(all), 0.1);
  EXPECT_EQ(all.observePlaces({kElsewhere}), PlaceUse::relocalized);
  EXPECT_NEAR(farOff(all), 20, 0.1);
  EXPECT_FALSE(all.isConfirmed());
  EXPECT_GT(all.predictPose({}).covariance(0, 0), 0.1 * 20 * 20);  // it covers the first room, too
  for (int i = 0; i < 3; ++i) all.observe(1 + 0.1 * i, {seen({}, {2, 0}), seen({}, {2, 1}, kBlue)});
  EXPECT_LT(farOff(all), 0.1);
  EXPECT_TRUE(all.isConfirmed());
}

TEST(LandmarkHypotheses, TheEvidenceOfImagesIsBoundedUntilTheRobotHasDriven) {
  LandmarkHypotheses all = inFirstRoom();
  for (int i = 0; i < 100; ++i) all.observePlaces({kElsewhere});
  EXPECT_EQ(all.size(), 2u);
  EXPECT_LT(all.probability(), 0.8);
  for (int i = 0; i < 40; ++i) {
    all.predict({{{0.5, 0}, 0}, 1e-4 * Matrix3d::Identity(), 0.5});
    all.observePlaces({{{{20 + 0.5 * (i + 1), 0}, 0}, kRough, 0.9}});
  }
  EXPECT_EQ(all.size(), 1u);
}

TEST(LandmarkHypotheses, AWrongImageIsForgottenByTheNextRightOnes) {
  LandmarkHypotheses all = inFirstRoom();
  all.observePlaces({kElsewhere});
  EXPECT_EQ(all.size(), 2u);
  all.observePlaces({{{}, kRough, 0.9}});
  all.observePlaces({{{}, kRough, 0.9}});
  EXPECT_EQ(all.size(), 1u);
}

TEST(LandmarkHypotheses, PlacesCorrectThePoseAfterADriveWithoutLandmarks) {
  LandmarkHypotheses all = inFirstRoom();
  const PossiblePose place{{{3.3, 0}, 0}, 0.01 * Matrix3d::Identity(), 0.9};
  for (int i = 0; i < 3; ++i) all.predict({{{1, 0}, 0}, 0.05 * Matrix3d::Identity(), 1});
  const PoseEstimate2D before = all.predictPose({});
  EXPECT_EQ(all.observePlaces({place}), PlaceUse::agrees);
  const PoseEstimate2D after = all.predictPose({});
  // The Kalman filter of one dimension: y and heading are correlated, but x is neither.
  const double variance = before.covariance(0, 0), gain = variance / (variance + 0.01);
  EXPECT_NEAR(after.pose.position.x(), before.pose.position.x() + gain * (3.3 - before.pose.position.x()),
              1e-3);
  EXPECT_NEAR(after.covariance(0, 0), (1 - gain) * variance, 1e-4);
  EXPECT_EQ(all.observePlaces({place}), PlaceUse::agrees);  // of the same place: its error is the same
  EXPECT_NEAR(all.predictPose({}).covariance(0, 0), after.covariance(0, 0), 1e-9);
}

TEST(LandmarkHypotheses, ObservationsThatTheMapDoesNotExplainAreCounted) {
  LandmarkHypotheses all = inFirstRoom();
  const LandmarkReport good = all.observe(1, {seen({}, {2, 0}), seen({}, {2, 1}, kBlue)});
  EXPECT_EQ(good.missed + good.unexpected, 0);
  const LandmarkReport moved = all.observe(1.1, {seen({}, {3, -2}), seen({}, {3, 3}, kBlue)});
  EXPECT_EQ(moved.missed, 2);
  EXPECT_EQ(moved.unexpected, 2);
}

TEST(LandmarkHypotheses, ACameraOfMarkersMissesNoOtherLandmark) {
  for (const Detects detects : {Detects::all, Detects::with_id}) {
    LandmarkHypotheses all = inFirstRoom();
    for (int i = 0; i < 60; ++i) all.observe(1 + 0.1 * i, {}, {}, detects);
    all.observe(8, {seen({}, {4, 3}, {"tag36h11", 3})}, {}, detects);  // it works, and sees neither pillar
    EXPECT_EQ(all.best().isLost(), detects == Detects::all);
  }
}

// ---- sources that are wrong

const LandmarkLabel kMarker{"tag36h11", 3};
const Landmark2D kOfMarker{{3, -1}, 1.0};

/// A robot in a room with two landmarks and a marker, whose map is complete.
LandmarkHypotheses amongThreeSources() {
  LandmarkSlamParams params;
  params.sensor.field_of_view = 6;
  params.read_only = true;
  LandmarkSlam slam(params, {}, 1e-4 * Matrix3d::Identity());
  slam.setMap({}, {{{2, 0}, {}}, {{2, 1}, {}}, kOfMarker}, {kRed, kBlue, kMarker},
              1e-4 * MatrixXd::Identity(10, 10));
  return LandmarkHypotheses(slam);
}

/// The marker as it is observed if its map is moved.
LabelledObservation marker(const Pose2& robot, const Vector2d& moved = {0, 0}) {
  const Landmark2D in_robot = toRobotFrame(robot, {kOfMarker.position + moved, kOfMarker.heading});
  return {kMarker, {in_robot.position, in_robot.heading, 1e-4 * Matrix3d::Identity()}};
}

LandmarkReport observePillars(LandmarkHypotheses& all, double stamp, const Pose2& robot = {},
                              const Vector2d& moved = {0, 0}) {
  const Vector2d red(2, 0), blue(2, 1);
  return all.observe(stamp, {seen(robot, red + moved), seen(robot, blue + moved, kBlue)});
}

TEST(LandmarkHypotheses, MarkersThatContradictThePoseAreExcludedUntilTheyAgree) {
  LandmarkHypotheses all = amongThreeSources();
  observePillars(all, 0);
  for (int i = 0; i < 30; ++i) {
    const LandmarkReport report = all.observe(0.2 * i, {marker({}, {0, 2})}, {}, Detects::with_id);
    EXPECT_EQ(report.associated, 0);
    observePillars(all, 0.2 * i + 0.1);
    EXPECT_LT(farOff(all), 0.1);
    EXPECT_LT(all.predictPose({}).covariance(1, 1), 0.01);
    if (i >= 10) {
      EXPECT_EQ(report.excluded, 1);
    }
  }
  for (int i = 0; i < 10; ++i) all.observe(7 + 0.2 * i, {marker({})}, {}, Detects::with_id);
  EXPECT_EQ(all.observe(9, {marker({})}, {}, Detects::with_id).associated, 1);
}

TEST(LandmarkHypotheses, UntilAnotherSourceDecidesThePoseIsUncertain) {
  LandmarkHypotheses all = amongThreeSources();
  observePillars(all, 0);
  all.predict({{{1, 0}, 0}, 1e-4 * Matrix3d::Identity(), 1});
  const Pose2 carried{{1, -1.5}, 0};  // or the marker is wrong
  for (int i = 0; i < 3; ++i) {
    all.observe(1 + 0.2 * i, {marker(carried)}, {}, Detects::with_id);
    const PoseEstimate2D open = all.predictPose({});
    if (i == 0) continue;  // a single scan may be a false alarm
    EXPECT_LT((open.pose.position - carried.position).norm(), 3 * std::sqrt(open.covariance(1, 1)));
    EXPECT_LT((open.pose.position - Vector2d(1, 0)).norm(), 3 * std::sqrt(open.covariance(1, 1)));
  }
  for (int i = 0; i < 30; ++i) {
    observePillars(all, 2 + 0.2 * i, carried);
    all.observe(2.1 + 0.2 * i, {marker(carried)}, {}, Detects::with_id);
  }
  ASSERT_FALSE(all.best().isLost());
  EXPECT_LT((all.best().filter().pose().position - carried.position).norm(), 0.1);
}

// The marker is off by four standard deviations, which an odometry without landmarks just allows.
TEST(LandmarkHypotheses, AMarkerThatIsHardlyWhereItIsExpectedMayBeWrong) {
  LandmarkHypotheses all = amongThreeSources();
  observePillars(all, 0);
  const double sigma = 0.3;
  all.predict({{{0.5, 0}, 0}, sigma * sigma * Matrix3d(Eigen::Vector3d(1, 1, 0.01).asDiagonal()), 0.5});
  const Pose2 robot{{0.5, 0}, 0};
  const Vector2d off(0, 4 * sigma);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(all.observe(1 + 0.2 * i, {marker(robot, off)}, {}, Detects::with_id).associated, 1);
    EXPECT_GT(all.size(), 1u);
    EXPECT_LT(all.probability(), 0.999);
  }
  for (int i = 0; i < 20; ++i) observePillars(all, 3 + 0.2 * i, robot);
  EXPECT_LT((all.best().filter().pose().position - robot.position).norm(), 0.05);
  EXPECT_EQ(all.wrongSources(), std::vector<PoseSource>{PoseSource::markers});
}

// Two places look alike. The marker, which no image can be mistaken for, is seen from one of them.
TEST(LandmarkHypotheses, AnImageDoesNotOutweighMarkersThatAgreedWithAnEarlierOne) {
  LandmarkHypotheses all = amongThreeSources();
  observePillars(all, 0);
  const Pose2 carried{{1, -4}, 0}, twin{{20, 0}, 0};
  const auto see_marker = [&](double begin) {
    for (int i = 0; i < 4; ++i) all.observe(begin + 0.2 * i, {marker(carried)}, {}, Detects::with_id);
  };
  see_marker(1);
  all.observePlaces({{carried, kRough, 0.87}, {twin, kRough, 0.08}});
  see_marker(2);
  all.observePlaces({{twin, kRough, 0.55}, {carried, kRough, 0.4}});
  EXPECT_LT((all.best().filter().pose().position - carried.position).norm(), 0.1);
  EXPECT_GT(all.probability(), 0.5);
}

TEST(LandmarkHypotheses, AMarkerThatIsNotInTheMapDoesNotExcludeTheOthers) {
  LandmarkHypotheses all = amongThreeSources();
  const LabelledObservation unknown{{"tag36h11", 9}, {{2, 2}, 0.5, 1e-4 * Matrix3d::Identity()}};
  for (int i = 0; i < 30; ++i) {
    observePillars(all, 0.2 * i);
    EXPECT_EQ(all.observe(0.2 * i + 0.1, {unknown}, {}, Detects::with_id).excluded, 0);
  }
  EXPECT_EQ(all.observe(7, {marker({})}, {}, Detects::with_id).associated, 1);
}

TEST(LandmarkHypotheses, LandmarksThatWereMovedAreExcluded) {
  LandmarkHypotheses all = amongThreeSources();
  all.observe(0, {marker({})}, {}, Detects::with_id);
  for (int i = 0; i < 30; ++i) {
    const LandmarkReport report = observePillars(all, 0.2 * i, {}, {1.5, -2});
    if (i >= 10) {
      EXPECT_EQ(report.excluded, 2);
    }
    all.observe(0.2 * i + 0.1, {marker({})}, {}, Detects::with_id);
    EXPECT_LT(farOff(all), 0.1);
  }
}

TEST(LandmarkHypotheses, WithoutAnotherSourceARobotThatSeesMarkersElsewhereIsLost) {
  LandmarkHypotheses all = amongThreeSources();
  for (int i = 0; i < 30; ++i) {
    const LandmarkReport report = all.observe(0.2 * i, {marker({}, {0, 6})}, {}, Detects::with_id);
    EXPECT_EQ(report.excluded, 0);
    if (report.lost) return;
  }
  EXPECT_LT((all.best().filter().pose().position - Vector2d(0, -6)).norm(), 0.1);
}

}  // namespace
}  // namespace sextant
