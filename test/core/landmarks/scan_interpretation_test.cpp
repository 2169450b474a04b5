// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/scan_interpretation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

const LandmarkLabel kRed{"red", {}}, kBlue{"blue", {}};

LabelledObservation seen(double x, double y, const LandmarkLabel& label = kRed) {
  return {label, {{x, y}, {}, 1e-2 * Matrix3d::Identity()}};
}

/// A map and what else is known; the robot is at the origin.
struct Known {
  explicit Known(const std::vector<Vector2d>& landmarks, const LandmarkLabel& label = kRed)
      : map({}, {}, Matrix3d::Identity()) {
    const auto size = static_cast<Eigen::Index>(3 + 2 * landmarks.size());
    std::vector<Landmark2D> all;
    for (const Vector2d& each : landmarks) all.push_back({each, {}});
    map.setMap({}, all, std::vector<LandmarkLabel>(landmarks.size(), label),
               1e-4 * MatrixXd::Identity(size, size));
  }

  std::vector<ScanInterpretation> interpreted(const std::vector<LabelledObservation>& scan, size_t most = 4) {
    const MapKnowledge knowledge{sensor, association, candidates, unused, explored, unconfirmed};
    return interpretScan(map, knowledge, scan, {}, most);
  }

  LandmarkRegister map;
  LandmarkSensor sensor{LandmarkSensorParams()};
  AssociationParams association;
  LandmarkCandidates candidates{CandidateParams()}, unused{CandidateParams()};
  ExploredArea explored;
  double unconfirmed = 0;
};

TEST(ScanInterpretation, WhatIsCertainHasOne) {
  Known known({{3, 0}, {3, 2}});
  const auto all = known.interpreted({seen(3.05, 0)});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].outcomes[0].outcome, Outcome::associated);
  EXPECT_EQ(all[0].outcomes[0].landmark, 0u);
  EXPECT_FALSE(all[0].slipped);
}

TEST(ScanInterpretation, BetweenTwoLandmarksThereIsOneForEach) {
  Known known({{3, 0.2}, {3, -0.2}});
  const auto all = known.interpreted({seen(3, 0.02)});
  ASSERT_EQ(all.size(), 3u);  // and one in which it is neither
  EXPECT_EQ(all[0].outcomes[0].landmark, 0u);
  EXPECT_EQ(all[1].outcomes[0].landmark, 1u);
  EXPECT_EQ(all[2].outcomes[0].outcome, Outcome::ambiguous);
  EXPECT_GT(all[0].log_likelihood, all[1].log_likelihood);
  EXPECT_GT(all[1].log_likelihood, all[2].log_likelihood);
  const auto best = known.interpreted({seen(3, 0.02)}, 1);
  ASSERT_EQ(best.size(), 1u);
  EXPECT_EQ(best[0].outcomes[0].outcome, Outcome::ambiguous);
}

// One landmark of the label, the unknown one, on the 2 m by 2 m around the robot; where it looked twice,
// those are left that it missed twice.
TEST(ScanInterpretation, ANewLandmarkIsAsLikelyAsTheMapIsDense) {
  Known empty({});
  EXPECT_NEAR(empty.interpreted({seen(3, 0)})[0].log_likelihood, std::log(1.0 / 4), 1e-9);
  for (const double x : {-1.0, 0.0}) empty.explored.look({{x, 0}, 0}, empty.sensor);
  const double missed_twice = std::pow(1 - empty.sensor.detectionProbability(), 2);
  EXPECT_NEAR(empty.interpreted({seen(3, 0)})[0].log_likelihood, std::log(1.0 / 4 * missed_twice), 1e-9);
  EXPECT_NEAR(empty.interpreted({seen(-3, 0)})[0].log_likelihood, std::log(1.0 / 4), 1e-9);
  Known one({{-20, 8}}, kBlue);
  EXPECT_NEAR(one.interpreted({seen(3, 0)})[0].log_likelihood, std::log(1.0 / (22 * 10)), 1e-9);
  EXPECT_NEAR(one.interpreted({seen(3, 0, kBlue)})[0].log_likelihood, std::log(2.0 / (22 * 10)), 1e-9);
}

TEST(ScanInterpretation, MissingALandmarkIsLessLikely) {
  Known with({{3, 0}, {3, 1}}), without({{3, 0}, {-3, 1}});
  const auto miss = with.interpreted({seen(3, 0)}), none = without.interpreted({seen(3, 0)});
  EXPECT_EQ(miss[0].in_view.size(), 2u);
  EXPECT_EQ(none[0].in_view.size(), 1u);
  EXPECT_NEAR(miss[0].log_likelihood - none[0].log_likelihood,
              std::log(1 - with.sensor.detectionProbability()), 1e-3);
}

TEST(ScanInterpretation, OdometryMaySlipOnlyAfterADriveWithoutLandmarks) {
  Known known({{3, 0}});
  const auto slips = [&] {
    int count = 0;
    for (const ScanInterpretation& each : known.interpreted({seen(3.8, 0)})) count += each.slipped;
    return count;
  };
  EXPECT_EQ(slips(), 0);
  known.unconfirmed = 2;
  EXPECT_EQ(slips(), 1);
}

TEST(ScanInterpretation, AnIdDecides) {
  Known known({{3, 0.02}}, {"tag", 7});
  const auto all = known.interpreted({seen(3, 0, {"tag", 7})});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].outcomes[0].outcome, Outcome::associated);
  EXPECT_EQ(known.interpreted({seen(3, 0, {"tag", 8})})[0].outcomes[0].outcome, Outcome::unassociated);
}

}  // namespace
}  // namespace sextant
