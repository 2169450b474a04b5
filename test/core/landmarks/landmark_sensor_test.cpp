// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

using Found = std::vector<size_t>;

ObservationPrediction at(const std::vector<Vector2d>& positions, double sigma = 0.0) {
  ObservationPrediction expected{
      Eigen::VectorXd(2 * positions.size()),
      sigma * sigma * MatrixXd::Identity(2 * positions.size(), 2 * positions.size())};
  for (size_t i = 0; i < positions.size(); ++i) expected.positions.segment<2>(2 * i) = positions[i];
  return expected;
}

Vector2d polar(double range, double direction) {
  return {range * std::cos(direction), range * std::sin(direction)};
}

LandmarkSensorParams params() {
  LandmarkSensorParams params;
  params.max_range = 4;
  params.field_of_view = 1.0;
  params.landmark_width = 0.2;
  return params;
}

TEST(LandmarkSensor, ItsDetectionProbabilityIsThatOfItsDetections) {
  LandmarkSensorParams known = params();
  known.detection_probability = 0.8;
  known.false_alarm_probability = 0.05;
  LandmarkSensor sensor(known);
  EXPECT_DOUBLE_EQ(sensor.detectionProbability(), 0.8);
  sensor.count(3, 7);
  EXPECT_DOUBLE_EQ(sensor.detectionProbability(), (16 + 3) / 30.0);
  const double before = sensor.evidence(false);
  for (int scan = 0; scan < 1000; ++scan) sensor.count(3, 7);
  EXPECT_NEAR(sensor.detectionProbability(), 0.3, 2e-3);
  EXPECT_NEAR(sensor.evidence(false), std::log(0.7 / 0.95), 5e-3);
  EXPECT_GT(sensor.evidence(false), before);
  for (int scan = 0; scan < 100000; ++scan) sensor.count(0, 10);  // each detection is still some evidence
  EXPECT_NEAR(sensor.evidence(true), std::log(1.5), 1e-9);
  EXPECT_LT(sensor.evidence(false), 0);
}

TEST(LandmarkSensor, ExpectsLandmarksInItsSector) {
  LandmarkSensorParams thin = params();
  thin.landmark_width = 0;
  const LandmarkSensor sensor(thin);
  EXPECT_EQ(sensor.expectedInView(at({polar(3.99, 0), polar(4.01, 0.3), polar(2, 0.49), polar(2, -0.49),
                                      polar(2, 0.51), polar(2, -0.51), polar(1, M_PI)})),
            (Found{0, 2, 3}));
  EXPECT_TRUE(sensor.expectedInView(at({})).empty());
}

TEST(LandmarkSensor, DoesNotExpectLandmarksBelowTheMinimumRange) {
  LandmarkSensorParams far = params();
  far.landmark_width = 0;
  far.min_range = 1;
  const LandmarkSensor sensor(far);
  EXPECT_EQ(sensor.expectedInView(at({polar(0.99, 0), polar(1.01, 0.1)})), Found{1});
  EXPECT_TRUE(sensor.expectedInView(at({polar(1.29, 0)}, 0.1)).empty());
  EXPECT_FALSE(sensor.expectedInView(at({polar(1.31, 0)}, 0.1)).empty());
}

// Three deviations are what a landmark may be off.
TEST(LandmarkSensor, ExpectsOnlyLandmarksThatCannotBeOutside) {
  const LandmarkSensor sensor(params());
  const auto sees = [&](const Vector2d& position) {
    return !sensor.expectedInView(at({position}, 0.1)).empty();
  };
  EXPECT_TRUE(sees(polar(3.69, 0)));
  EXPECT_FALSE(sees(polar(3.71, 0)));
  const double edge = 0.5 - std::asin(0.3 / 2);
  EXPECT_TRUE(sees(polar(2, edge - 0.01)));
  EXPECT_FALSE(sees(polar(2, edge + 0.01)));
  EXPECT_FALSE(sees(polar(0.2, 0)));  // it may be behind the robot
}

TEST(LandmarkSensor, AFullCircleHasNoEdge) {
  LandmarkSensorParams around = params();
  around.field_of_view = 2 * M_PI;
  const LandmarkSensor sensor(around);
  EXPECT_EQ(sensor.expectedInView(at({polar(3, M_PI), polar(3, -2.8), polar(3, 1.5)}, 0.01)),
            (Found{0, 1, 2}));
}

TEST(LandmarkSensor, LandmarksBehindOthersAreOccluded) {
  const LandmarkSensor sensor(params());
  EXPECT_EQ(sensor.expectedInView(at({{1, 0}, {3, 0.1}})), (Found{0}));
  EXPECT_EQ(sensor.expectedInView(at({{3, 0.1}, {1, 0}})), (Found{1}));
  EXPECT_EQ(sensor.expectedInView(at({{1, 0.3}, {3, 0}})), (Found{0, 1}));
  EXPECT_EQ(sensor.expectedInView(at({{1, 0.3}, {3, 0}}, 0.05)), (Found{0}));  // it may be in the way
  EXPECT_EQ(sensor.expectedInView(at({{-1, 0}, {3, 0}})), (Found{1}));         // behind the robot
}

// p(seen | there) / p(seen | not there), as of Thrun, Burgard and Fox 2005, section 4.2.
TEST(LandmarkSensor, EvidenceIsTheLogOfTheLikelihoodRatio) {
  LandmarkSensorParams known = params();
  known.detection_probability = 0.9;
  known.false_alarm_probability = 0.1;
  const LandmarkSensor sensor(known);
  EXPECT_NEAR(sensor.evidence(true), std::log(9), 1e-12);
  EXPECT_NEAR(sensor.evidence(false), -std::log(9), 1e-12);
}

TEST(LandmarkSensor, LargestDeviationIsThatOfTheLongAxis) {
  const Matrix2d R = rotation2(0.7);
  EXPECT_NEAR(largestDeviation(R * Vector2d(0.04, 0.25).asDiagonal() * R.transpose()), 0.5, 1e-12);
  EXPECT_EQ(largestDeviation(-Matrix2d::Identity()), 0);
}

TEST(LandmarkSensor, UsesThePoseOfTheSensor) {
  const LandmarkSensor sensor(params());
  const auto expected = at({{3, 0}, {0, 3}, {-3, 0}, {-4.2, 0}});
  EXPECT_EQ(sensor.expectedInView(expected, {{0, 0}, M_PI / 2}), (Found{1}));
  EXPECT_EQ(sensor.expectedInView(expected, {{0, 0}, M_PI}), (Found{2}));
  EXPECT_EQ(sensor.expectedInView(expected, {{-3.5, 0}, M_PI}), (Found{3}));
}

TEST(LandmarkSensor, NamesAFieldThatIsOutOfRange) {
  const std::vector<std::pair<std::string, std::function<void(LandmarkSensorParams&)>>> mistakes{
      {"max_range", [](auto& params) { params.max_range = 0; }},
      {"min_range", [](auto& params) { params.min_range = params.max_range + 1; }},
      {"field_of_view", [](auto& params) { params.field_of_view = 6.3; }},
      {"detection_probability", [](auto& params) { params.detection_probability = 1; }},
      {"false_alarm_probability", [](auto& params) { params.false_alarm_probability = 0; }},
      {"landmark_width", [](auto& params) { params.landmark_width = -1; }},
      {"min_separation", [](auto& params) { params.min_separation = std::nan(""); }}};
  for (const auto& [name, spoil] : mistakes) {
    LandmarkSensorParams params;
    spoil(params);
    EXPECT_EQ(
        refusal<std::invalid_argument>([&, &params = params] { LandmarkSensor{params}; }).find(name + " is "),
        0u)
        << name;
  }
}

}  // namespace
}  // namespace sextant
