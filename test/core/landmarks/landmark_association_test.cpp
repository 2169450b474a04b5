// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_association.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <set>

#include "test_matrices.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

const LandmarkLabel kRed{"red", {}}, kBlue{"blue", {}};

PositionObservation seen(const Vector2d& position, const LandmarkLabel& label = kRed, double sigma = 0.1) {
  return {position, sigma * sigma * Matrix2d::Identity(), label};
}

MatrixXd alone(size_t landmarks, double sigma = 0.1) {
  return sigma * sigma * MatrixXd::Identity(2 * landmarks, 2 * landmarks);
}

/// Landmarks that are not known yet are as good as nowhere.
AssociationParams withoutNew() {
  AssociationParams params;
  params.new_landmark_density = 1e-12;
  return params;
}

double quantileOf(double probability, size_t pairs) {
  return quantile(boost::math::chi_squared(2.0 * pairs), probability);
}

struct Case {
  std::vector<LandmarkPoint> landmarks;
  MatrixXd covariance;
  std::vector<PositionObservation> observations;
};

/// A few landmarks with correlated errors, observations of some of them, and false alarms.
Case randomCase(std::mt19937& random) {
  std::uniform_int_distribution<int> few(1, 4), coin(0, 1);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  std::normal_distribution<double> noise(0, 1);
  Case drawn;
  const int count = few(random);
  const MatrixXd A =
      0.12 * MatrixXd::NullaryExpr(2 * count, 2 * count + 3, [&](auto, auto) { return noise(random); });
  drawn.covariance = A * A.transpose() + 1e-4 * MatrixXd::Identity(2 * count, 2 * count);
  const VectorXd off = A * VectorXd::NullaryExpr(2 * count + 3, [&](auto) { return noise(random); });
  for (int j = 0; j < count; ++j) {
    drawn.landmarks.push_back({{anywhere(random), anywhere(random)}, coin(random) ? kRed : kBlue});
    const Vector2d where =
        drawn.landmarks[j].position + off.segment<2>(2 * j) + 0.1 * Vector2d{noise(random), noise(random)};
    if (coin(random)) drawn.observations.push_back(seen(where, drawn.landmarks[j].label));
    if (coin(random)) drawn.observations.push_back(seen({anywhere(random), anywhere(random)}));
  }
  if (drawn.observations.size() > 5) drawn.observations.resize(5);
  return drawn;
}

using Assignment = std::vector<int>;  // landmark of each observation, or -1

double distanceOf(const Case& given, const Assignment& assignment) {
  std::vector<Eigen::Index> rows;
  std::vector<double> off;
  for (size_t i = 0; i < assignment.size(); ++i)
    for (int axis = 0; axis < 2 && assignment[i] >= 0; ++axis) {
      rows.push_back(2 * assignment[i] + axis);
      off.push_back(given.observations[i].position(axis) - given.landmarks[assignment[i]].position(axis));
    }
  if (rows.empty()) return 0;
  const MatrixXd S = picked(given.covariance, rows, rows) + alone(rows.size() / 2);
  const Eigen::Map<VectorXd> innovation(off.data(), off.size());
  return innovation.dot(S.ldlt().solve(innovation));
}

size_t sizeOf(const Assignment& assignment) {
  return std::count_if(assignment.begin(), assignment.end(), [](int landmark) { return landmark >= 0; });
}

/// Also all that it grows from is.
bool isCompatible(const Case& given, Assignment assignment) {
  for (size_t i = assignment.size(); i-- > 0;) {
    Assignment single(assignment.size(), -1);
    single[i] = assignment[i];
    for (const Assignment& part : {assignment, single})
      if (sizeOf(part) && distanceOf(given, part) >= quantileOf(0.999, sizeOf(part))) return false;
    assignment[i] = -1;
  }
  return true;
}

/// Every assignment of landmarks to observations of their class.
void forAll(const Case& given, Assignment& assignment, const std::function<void(const Assignment&)>& call) {
  if (assignment.size() == given.observations.size()) return call(assignment);
  for (int j = -1; j < static_cast<int>(given.landmarks.size()); ++j) {
    const bool is_taken = j >= 0 && std::count(assignment.begin(), assignment.end(), j);
    if (is_taken || (j >= 0 && !(given.landmarks[j].label == given.observations[assignment.size()].label)))
      continue;
    assignment.push_back(j);
    forAll(given, assignment, call);
    assignment.pop_back();
  }
}

Assignment bestOfAll(const Case& given) {
  Assignment best(given.observations.size(), -1), drawn;
  forAll(given, drawn, [&](const Assignment& each) {
    const size_t size = sizeOf(each), most = sizeOf(best);
    if (size < most || (size == most && distanceOf(given, each) >= distanceOf(given, best))) return;
    if (isCompatible(given, each)) best = each;
  });
  return best;
}

TEST(LandmarkAssociation, FindsTheBestOfAllJointAssignments) {
  AssociationParams params = withoutNew();
  params.ambiguity_margin = 0;
  std::mt19937 random(1);
  size_t pairs = 0;
  for (int i = 0; i < 300; ++i) {
    const Case given = randomCase(random);
    const Assignment expected = bestOfAll(given);
    const auto found = associate(given.landmarks, given.covariance, given.observations, params);
    ASSERT_EQ(found.size(), expected.size());
    for (size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].outcome == Outcome::associated, expected[k] >= 0) << "case " << i;
      if (expected[k] < 0) continue;
      EXPECT_EQ(static_cast<int>(found[k].landmark), expected[k]) << "case " << i;
    }
    pairs += sizeOf(expected);
  }
  EXPECT_GT(pairs, 200u);
}

TEST(LandmarkAssociation, ClassAndIdMustMatch) {
  const std::vector<LandmarkPoint> landmarks{{{1, 0}, kRed}, {{3, 0}, {"tag", 7}}};
  const auto found =
      associate(landmarks, alone(2),
                {seen({1, 0}, kBlue), seen({3, 0}, {"tag", 8}), seen({3, 0}, {"tag", 7}), seen({1, 0.05})},
                withoutNew());
  EXPECT_EQ(found[0].outcome, Outcome::unassociated);
  EXPECT_EQ(found[1].outcome, Outcome::unassociated);
  EXPECT_EQ(found[2].outcome, Outcome::associated);
  EXPECT_EQ(found[2].landmark, 1u);
  EXPECT_EQ(found[3].outcome, Outcome::associated);
  EXPECT_EQ(found[3].landmark, 0u);
}

/// What becomes of one red observation.
Outcome outcomeOf(const std::vector<LandmarkPoint>& landmarks, const Vector2d& position,
                  const AssociationParams& params) {
  return associate(landmarks, alone(landmarks.size()), {seen(position)}, params)[0].outcome;
}

TEST(LandmarkAssociation, BetweenTheGatesAnObservationIsAmbiguous) {
  const AssociationParams params = withoutNew();
  const auto at = [&](double squared) {  // 0.02 m^2 is what is not known of an axis
    return outcomeOf({{{1, 2}, kRed}}, Vector2d(1 + std::sqrt(0.02 * squared), 2), params);
  };
  const double gate = quantileOf(params.gate, 1), new_gate = quantileOf(params.new_landmark_gate, 1);
  EXPECT_EQ(at(0.99 * gate), Outcome::associated);
  EXPECT_EQ(at(1.01 * gate), Outcome::ambiguous);
  EXPECT_EQ(at(0.99 * new_gate), Outcome::ambiguous);
  EXPECT_EQ(at(1.01 * new_gate), Outcome::unassociated);
}

TEST(LandmarkAssociation, ObservationsThatTwoLandmarksExplainAreAmbiguous) {
  AssociationParams params = withoutNew();  // squared distances from 0.1 and -0.1: their difference is 20 x
  const std::vector<LandmarkPoint> twins{{{0.1, 0}, kRed}, {{-0.1, 0}, kRed}};
  EXPECT_EQ(outcomeOf(twins, {0.01, 0}, params), Outcome::ambiguous);
  EXPECT_EQ(outcomeOf(twins, {0.299, 0}, params), Outcome::ambiguous);
  EXPECT_EQ(outcomeOf(twins, {0.301, 0}, params), Outcome::associated);
  params.ambiguity_margin = 0;
  EXPECT_EQ(outcomeOf(twins, {0.01, 0}, params), Outcome::associated);
}

// The likelihood of a landmark against the density of those that are not known, closed form.
TEST(LandmarkAssociation, ObservationsThatANewLandmarkExplainsAreAmbiguous) {
  AssociationParams params;
  const double even = 1 / (2 * M_PI * 0.02), squared = 5;  // density at the landmark, 1/m^2
  params.new_landmark_density = even * std::exp(-0.5 * (squared + params.new_landmark_margin));
  const auto at = [&](double distance) {
    return outcomeOf({{{1, 2}, kRed}}, Vector2d(1, 2 + std::sqrt(0.02 * distance)), params);
  };
  EXPECT_EQ(at(0.999 * squared), Outcome::associated);
  EXPECT_EQ(at(1.001 * squared), Outcome::ambiguous);
}

// The pose error of a metre shifts all observations: each alone is nearest to the wrong landmark.
TEST(LandmarkAssociation, JointCompatibilityCorrectsTheNearestNeighbour) {
  const std::vector<LandmarkPoint> landmarks{{{0, 2}, kRed}, {{1, 2}, kRed}, {{2.1, 2}, kRed}};
  MatrixXd common(6, 2);
  common << MatrixXd::Identity(2, 2), MatrixXd::Identity(2, 2), MatrixXd::Identity(2, 2);
  const MatrixXd covariance = 0.5 * common * common.transpose() + alone(3, 0.01);
  const std::vector<PositionObservation> observations{seen({0.9, 2}, kRed, 0.02), seen({1.9, 2}, kRed, 0.02),
                                                      seen({3.0, 2}, kRed, 0.02)};
  const auto joint = associate(landmarks, covariance, observations, withoutNew());
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(joint[i].outcome, Outcome::associated);
    EXPECT_EQ(joint[i].landmark, i);
  }
}

TEST(LandmarkAssociation, WithoutLandmarksAllIsUnknown) {
  EXPECT_TRUE(associate({{{1, 0}, kRed}}, alone(1), {}, {}).empty());
  EXPECT_EQ(associate({}, MatrixXd(0, 0), {seen({1, 0})}, {})[0].outcome, Outcome::unassociated);
}

// 15! assignments in one heap; the search ends, and gives a landmark to one observation only.
TEST(LandmarkAssociation, EndsAfterMaxHypotheses) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<LandmarkPoint> landmarks;
  std::vector<PositionObservation> observations;
  for (int i = 0; i < 15; ++i) {
    landmarks.push_back({{noise(random), noise(random)}, kRed});
    observations.push_back(seen({noise(random), noise(random)}));
  }
  AssociationParams params = withoutNew();
  params.max_hypotheses = 1000;
  params.ambiguity_margin = 0;
  std::set<size_t> taken;
  size_t known = 0;
  for (const Association& each : associate(landmarks, alone(15), observations, params))
    if (each.outcome == Outcome::associated) ++known, taken.insert(each.landmark);
  EXPECT_EQ(taken.size(), known);
}

TEST(LandmarkAssociation, ReturnsTheBestHypothesisUntilThen) {
  std::vector<LandmarkPoint> landmarks;
  std::vector<PositionObservation> observations;
  for (int i = 0; i < 130; ++i) {
    landmarks.push_back({{5.0 * i, 0}, kRed});
    observations.push_back(seen({5.0 * i, 0}));
  }
  AssociationParams params = withoutNew();
  params.max_hypotheses = 100;
  const auto found = associate(landmarks, alone(130), observations, params);
  EXPECT_EQ(found[99].outcome, Outcome::associated);
}

TEST(LandmarkAssociation, NamesAFieldThatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, std::function<void(AssociationParams&)>>> mistakes{
      {"gate", [](auto& params) { params.gate = 1; }},
      {"new_landmark_gate", [](auto& params) { params.new_landmark_gate = 0.9; }},
      {"ambiguity_margin", [](auto& params) { params.ambiguity_margin = -1; }},
      {"new_landmark_density", [](auto& params) { params.new_landmark_density = 0; }},
      {"new_landmark_margin", [nan](auto& params) { params.new_landmark_margin = nan; }},
      {"max_hypotheses", [](auto& params) { params.max_hypotheses = 99; }}};
  validate(AssociationParams());
  for (const auto& [name, spoil] : mistakes) {
    AssociationParams params;
    spoil(params);
    EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }).find(name + " is "), 0u) << name;
  }
}

}  // namespace
}  // namespace sextant
