// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "known_markers.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "test_recording.hpp"

namespace sextant {
namespace {

// Markers that were known with a deviation, and the minimum where all else sees each of them `offset` away
// with another one: (S^-1 + R^-1)^-1 is its covariance, and S / (S + R) the share of the way that it went.
struct KnownRoom {
  KnownRoom(int count, double known_sigma, double seen_sigma, const Vector6d& offset) {
    const double S = known_sigma * known_sigma, R = seen_sigma * seen_sigma;
    const MarkerMap truth = roomWithMarkers(count);
    for (auto [marker_key, marker] : truth.markers()) {
      marker.covariance = S * Matrix6d::Identity();
      held.add(marker);
      marker.T_map_marker = perturbed(marker.T_map_marker, S / (S + R) * offset);
      map.add(marker);
    }
    covariance = S * R / (S + R) * Eigen::MatrixXd::Identity(6 * count, 6 * count);
  }

  MarkerMap held, map;
  Eigen::MatrixXd covariance;
};

Vector6d alongX(double offset) { return offset * Vector6d::Unit(0); }

TEST(KnownMarkers, AreCheckedAgainstWhatAllElseSays) {
  for (const int axis : {0, 2, 4}) {
    const KnownRoom room(1, 0.01, 0.005, 0.03 * Vector6d::Unit(axis));
    const auto checks = checkKnown(room.held, room.map, room.covariance);
    ASSERT_EQ(checks.size(), 1u);
    EXPECT_LT((checks[0].offset - 0.03 * Vector6d::Unit(axis)).norm(), 1e-6);
    EXPECT_NEAR(checks[0].squared_distance, 9 / (1 + 4 * 0.25), 1e-3);  // a recording is believed half
    EXPECT_FALSE(checks[0].wrong);
  }
  const KnownRoom far(1, 0.01, 0.001, alongX(0.05));
  EXPECT_TRUE(checkKnown(far.held, far.map, far.covariance)[0].wrong);
}

TEST(KnownMarkers, WhatIsExactOrWasNotSeenIsNotChecked) {
  KnownRoom room(3, 0.01, 0.005, alongX(0.03));
  room.covariance.block<6, 6>(6, 6).setZero();
  const MarkerMap exact = only(room.held, {0});
  EXPECT_TRUE(checkKnown(exact, room.map, room.covariance).empty());
  const auto checks = checkKnown(room.held, room.map, room.covariance);
  ASSERT_EQ(checks.size(), 2u);
  EXPECT_EQ(checks[1].key.id, 2);
}

// Half of the chi-square distribution of three degrees of freedom lies below 2.366.
TEST(KnownMarkers, TheirScaleMakesTheMedianThatOfItsDistribution) {
  const KnownRoom room(9, 0.01, 0.001, alongX(0.06));
  const KnownScales scales = knownScales(room.held, room.held, room.map, room.covariance);
  EXPECT_NEAR(scales.position, std::sqrt((36 / 2.366) - 0.01), 0.01);
  EXPECT_EQ(scales.rotation, 1);
  const MarkerMap scaled = scaledKnown(room.held, scales);
  EXPECT_NEAR(scaled.find(key(4))->covariance(1, 1), std::pow(0.01 * scales.position, 2), 1e-12);
  EXPECT_NEAR(scaled.find(key(4))->covariance(5, 5), 1e-4, 1e-12);
  const KnownRoom few(7, 0.01, 0.001, alongX(0.06)), good(9, 0.01, 0.001, alongX(0.01));
  EXPECT_EQ(knownScales(few.held, few.held, few.map, few.covariance).position, 1);
  EXPECT_EQ(knownScales(good.held, good.held, good.map, good.covariance).position, 1);
}

TEST(KnownMarkers, SeveralAreLoosenedAndOneIsNot) {
  const MarkerMap truth = roomWithMarkers(2);
  EXPECT_TRUE(loosenedKnown(only(truth, {0})).find(key(0))->covariance.isZero(0));
  const Matrix6d loose = loosenedKnown(truth).find(key(1))->covariance;
  EXPECT_TRUE(loose.isApprox(tapeCovariance(0.02, 0.03), 1e-12));
}

TEST(KnownMarkers, OneCanBeTakenOut) {
  const MarkerMap rest = withoutMarker(roomWithMarkers(3), key(1));
  EXPECT_EQ(rest.markers().size(), 2u);
  EXPECT_EQ(rest.find(key(1)), nullptr);
}

}  // namespace
}  // namespace sextant
