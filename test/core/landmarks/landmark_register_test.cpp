// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_register.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Keys = std::vector<int>;
using OptionalKeys = std::vector<std::optional<int>>;

LabelledObservation at(double x, double y, const std::string& class_name = "red", double sigma = 0.01) {
  return {{class_name, {}}, {{x, y}, {}, sigma * sigma * Matrix3d::Identity()}};
}

LandmarkRegister empty() { return {{}, {}, 1e-8 * Matrix3d::Identity()}; }

TEST(LandmarkRegister, KeysAreUnique) {
  LandmarkRegister all = empty();
  for (int i = 0; i < 3; ++i) all.add(at(i, 0));
  all.addEvidence({1}, -10);
  EXPECT_EQ(all.removeUnlikely(), 1);
  EXPECT_EQ(all.keys(), (Keys{0, 2}));
  EXPECT_NEAR(all.filter().landmarks()[1].position.x(), 2, 1e-9);
  all.add(at(5, 5));
  EXPECT_EQ(all.keys(), (Keys{0, 2, 3}));
  EXPECT_EQ(all.nextKey(), 4);
}

TEST(LandmarkRegister, WhatWasObservedLastIsPreciseInTheRobotFrame) {
  LandmarkRegister all = empty();
  all.add(at(1, 0));
  all.filter().predict(noisyStep({{100, 0}, M_PI / 2}, {}));
  all.add(at(2, 3));
  const std::vector<MapPoint> points = all.pointsInRobotFrame();
  EXPECT_LT((points[0].landmark.position - Eigen::Vector2d(0, 99)).norm(), 1e-9);
  EXPECT_GT(points[0].covariance.trace(), 0.1);
  EXPECT_LT((points[1].landmark.position - Eigen::Vector2d(2, 3)).norm(), 1e-9);
  EXPECT_LT((points[1].covariance - 1e-4 * Eigen::Matrix2d::Identity()).norm(), 1e-9);
}

// Log odds 0 to -4 in steps of -1: it is removed by the fourth miss that counts.
TEST(LandmarkRegister, OnlyTheFirstMissFromADirectionCounts) {
  LandmarkRegister all = empty();
  all.add(at(5, 0));
  for (int i = 0; i < 100; ++i) all.addMisses({0}, {}, -1);
  EXPECT_EQ(all.removeUnlikely(), 0);
  for (int view = 2; view <= 4; ++view) {
    all.filter().predict(noisyStep({{0, 1.5}, 0}, {}));  // the landmark is at a distance of 5 m and more
    EXPECT_EQ(all.removeUnlikely(), 0);
    all.addMisses({0}, {}, -1);
  }
  EXPECT_EQ(all.removeUnlikely(), 1);
}

TEST(LandmarkRegister, AMissCountsIfTheLandmarkNextToItWasObserved) {
  LandmarkRegister all = empty();
  all.add(at(5, 0));
  all.add(at(5, 0.9));
  all.add(at(5, 2.5));
  for (int i = 0; i < 4; ++i) all.addMisses({0, 2}, {1}, -1);
  EXPECT_EQ(all.removeUnlikely(), 1);
  EXPECT_EQ(all.keys(), (Keys{1, 2}));
}

TEST(LandmarkRegister, LogOddsHaveAnUpperBound) {
  LandmarkRegister often = empty(), always = empty();
  often.add(at(1, 0)), always.add(at(1, 0));
  for (int i = 0; i < 10; ++i) often.addEvidence({0}, 1);
  for (int i = 0; i < 10000; ++i) always.addEvidence({0}, 1);
  int scans = 0;
  for (; often.labels().size() == 1 && scans < 1000; ++scans) {
    for (LandmarkRegister* each : {&often, &always}) each->addEvidence({0}, -1);
    EXPECT_EQ(often.removeUnlikely(), always.removeUnlikely());
  }
  EXPECT_LT(scans, 20);
}

TEST(LandmarkRegister, MergingKeepsTheFirst) {
  LandmarkRegister all = empty();
  all.add(at(0, 0)), all.add(at(3, 0)), all.add(at(0.02, 0)), all.add(at(0.02, 0, "blue"));
  OptionalKeys keys{2, {}, 1};
  EXPECT_EQ(all.mergeDuplicates({2}, 0.3, keys), 1);
  EXPECT_EQ(all.keys(), (Keys{0, 1, 3}));
  EXPECT_EQ(keys, (OptionalKeys{0, {}, 1}));
  EXPECT_NEAR(all.filter().landmarks()[0].position.x(), 0.01,
              1e-6);  // the mean: both have the same covariance
}

TEST(LandmarkRegister, AMergedLandmarkIsComparedWithTheFirstAgain) {
  LandmarkRegister all = empty();
  all.add(at(0, 0)), all.add(at(0.36, 0)), all.add(at(0.18, 0));
  OptionalKeys keys;
  EXPECT_EQ(all.mergeDuplicates({1}, 0.3, keys), 2);  // at 0.27 m after the first merge
  EXPECT_EQ(all.keys(), (Keys{0}));
}

TEST(LandmarkRegister, LandmarksObservedTogetherAreNotMerged) {
  LandmarkRegister all = empty();
  all.add(at(0, 0)), all.add(at(0.02, 0));
  OptionalKeys keys;
  EXPECT_EQ(all.mergeDuplicates({0, 1}, 0.3, keys), 0);
}

TEST(LandmarkRegister, UncertainLandmarksAreNotMerged) {
  LandmarkRegister all = empty();
  all.add(at(0, 0)), all.add(at(0.02, 0, "red", 0.2));
  OptionalKeys keys;
  EXPECT_EQ(all.mergeDuplicates({1}, 0.3, keys), 0);
}

TEST(LandmarkRegister, ACopyIsIndependent) {
  LandmarkRegister all = empty();
  all.add(at(1, 2));
  LandmarkRegister copy(all), assigned = empty();
  assigned = all;
  all.add(at(3, 4));
  all.filter().setPose({{9, 9}, 1}, Matrix3d::Identity());
  for (const LandmarkRegister* each : {&copy, &assigned}) {
    EXPECT_EQ(each->labels().size(), 1u);
    EXPECT_EQ(each->filter().landmarks().size(), 1u);
    EXPECT_EQ(each->filter().pose().position.x(), 0);
  }
}

TEST(LandmarkRegister, AnInvalidMapChangesNothing) {
  LandmarkRegister all = empty();
  all.add(at(1, 2));
  const std::vector<Landmark2D> two(2);
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(7, 7);
  EXPECT_THROW(all.setMap({}, two, {{"red", {}}}, covariance), std::invalid_argument);
  EXPECT_THROW(all.setMap({}, two, {2, {"red", {}}}, covariance.topRows(6)), std::invalid_argument);
  EXPECT_EQ(all.labels().size(), 1u);
  EXPECT_EQ(all.filter().landmarks().size(), 1u);
  EXPECT_EQ(all.filter().covariance().rows(), 5);
}

TEST(LandmarkRegister, ANewMapHasNewKeys) {
  LandmarkRegister all = empty();
  all.add(at(1, 2));
  all.setMap({{1, 1}, 0}, {{{4, 4}, {}}, {{5, 5}, 0.5}}, {{"red", {}}, {"tag36h11", 3}},
             0.01 * Eigen::MatrixXd::Identity(8, 8));
  EXPECT_EQ(all.keys(), (Keys{1, 2}));
  EXPECT_EQ(all.find({"tag36h11", 3}), std::optional<size_t>(1));
  EXPECT_FALSE(all.find({"tag36h11", 4}));
  EXPECT_NEAR(all.points()[1].covariance(1, 1), 0.01, 1e-12);
}

}  // namespace
}  // namespace sextant
