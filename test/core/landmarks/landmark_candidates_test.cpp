// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_candidates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

PositionObservation at(double x, double y, const std::string& class_name = "red", double sigma = 0.1) {
  return {{x, y}, sigma * sigma * Matrix2d::Identity(), {class_name, {}}};
}

size_t landmarksOf(const std::vector<bool>& answer) { return std::count(answer.begin(), answer.end(), true); }

CandidateParams patient() {
  CandidateParams params;
  params.observations = 100;
  return params;
}

/// Whether an observation at this position matches the only candidate.
bool isTaken(LandmarkCandidates candidates, double x) {
  candidates.observe(0, {at(x, 2)});
  return candidates.size() == 1;
}

// The gate lies around the mean of all, 0.02: with weight 1/(1+n), and what is not known of it is 1/n of one.
TEST(LandmarkCandidates, IsTheMeanOfItsObservations) {
  LandmarkCandidates candidates(patient());
  for (const double x : {0.0, 0.1, -0.1, 0.2, -0.1}) candidates.observe(0, {at(x, 2)});
  ASSERT_EQ(candidates.size(), 1u);
  const double reach = std::sqrt(-2 * std::log(1 - 0.999) * 0.01 * (1 + 1.0 / 5));
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(isTaken(candidates, 0.02 + side * 0.999 * reach));
    EXPECT_FALSE(isTaken(candidates, 0.02 + side * 1.001 * reach));
  }
}

TEST(LandmarkCandidates, WithZeroObservationsTheFirstOneSuffices) {
  CandidateParams params;
  params.observations = 0;
  LandmarkCandidates candidates(params);
  EXPECT_EQ(candidates.observe(10, {at(0, 0), at(5, 5)}), (std::vector<bool>{true, true}));
  EXPECT_EQ(candidates.size(), 0u);
}

TEST(LandmarkCandidates, IsRemovedAfterItsMaximumAge) {
  CandidateParams params = patient();
  params.max_age = 2;
  LandmarkCandidates candidates(params);
  candidates.observe(10, {at(0, 0)});
  candidates.observe(11.5, {at(0, 0), at(5, 5)});
  candidates.observe(13.5, {});
  EXPECT_EQ(candidates.size(), 2u);  // two seconds are not too long
  candidates.observe(13.4, {at(5, 5)});
  candidates.observe(13.6, {});
  EXPECT_EQ(candidates.size(), 1u);
  candidates.clear();
  EXPECT_EQ(candidates.size(), 0u);
}

TEST(LandmarkCandidates, IsALandmarkBeyondItsObservations) {
  CandidateParams params;
  params.observations = 3;
  LandmarkCandidates candidates(params);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(landmarksOf(candidates.observe(i, {at(1, 2), at(7, 7 + i)})), 0u) << i;
  const std::vector<bool> fourth = candidates.observe(3, {at(-3, 2), at(1, 2)});
  EXPECT_EQ(fourth, (std::vector<bool>{false, true}));
  EXPECT_EQ(landmarksOf(candidates.observe(3.1, {at(1, 2)})), 0u);  // it is no candidate any more
}

TEST(LandmarkCandidates, OtherLabelsAreOtherCandidates) {
  CandidateParams params;
  params.observations = 1;
  LandmarkCandidates candidates(params);
  PositionObservation seven = at(1, 2), eight = at(1, 2);
  seven.label.id = 7, eight.label.id = 8;
  for (const auto& observation : {at(1, 2), at(1, 2, "blue"), seven, eight})
    EXPECT_EQ(landmarksOf(candidates.observe(0, {observation})), 0u);
  EXPECT_EQ(candidates.size(), 4u);
}

TEST(LandmarkCandidates, TwoObservationsOfOneScanAreTwoCandidates) {
  for (const double apart : {0.05, 0.0}) {
    CandidateParams params;
    params.observations = 2;
    LandmarkCandidates candidates(params);
    candidates.observe(0, {at(0, 0)});
    candidates.observe(1, {at(0.1, 0), at(0.1 - apart, 0)});
    EXPECT_EQ(candidates.size(), 2u) << apart;
    EXPECT_EQ(landmarksOf(candidates.observe(2, {at(0.05, 0)})), 1u) << apart;
    EXPECT_EQ(candidates.size(), 1u) << apart;
  }
}

TEST(LandmarkCandidates, NamesAFieldThatIsOutOfRange) {
  const std::vector<std::pair<std::string, std::function<void(CandidateParams&)>>> mistakes{
      {"gate", [](auto& params) { params.gate = 1; }},
      {"observations", [](auto& params) { params.observations = -1; }},
      {"max_age", [](auto& params) { params.max_age = 0; }}};
  validate(CandidateParams());
  for (const auto& [name, spoil] : mistakes) {
    CandidateParams params;
    spoil(params);
    EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }).find(name + " is "), 0u) << name;
  }
}

}  // namespace
}  // namespace sextant
