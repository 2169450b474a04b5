// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

#include "sextant/landmarks/landmark_slam.hpp"

namespace sextant {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

inline const Matrix3d kStart = 1e-4 * Matrix3d::Identity();
inline const LandmarkLabel kRed{"red", {}}, kBlue{"blue", {}};

struct Thing {
  PlaneLandmark landmark;
  LandmarkLabel label;
};

inline Thing pillar(double x, double y, const LandmarkLabel& label = kRed) { return {{{x, y}, {}}, label}; }
inline Thing tag(int id, double x, double y, double heading) { return {{{x, y}, heading}, {"tag", id}}; }

inline LabelledSighting seen(const Pose2& robot, const Thing& thing, double sigma = 0.03) {
  const PlaneLandmark at = seenFrom(robot, thing.landmark);
  return {thing.label, {at.position, at.heading, sigma * sigma * Matrix3d::Identity()}};
}

inline std::vector<LabelledSighting> allSeen(const Pose2& robot, const std::vector<Thing>& things) {
  std::vector<LabelledSighting> all;
  for (const Thing& each : things) all.push_back(seen(robot, each));
  return all;
}

inline LandmarkSlamParams params() {
  LandmarkSlamParams params;
  params.sensor.field_of_view = 3.0;
  return params;
}

/// A robot in the origin that knows things as surely as told.
inline LandmarkSlam knowing(const std::vector<Thing>& things, const LandmarkSlamParams& params,
                            double sigma = 0.01) {
  LandmarkSlam slam(params, {}, kStart);
  std::vector<PlaneLandmark> landmarks;
  std::vector<LandmarkLabel> labels;
  Eigen::Index size = 3;
  for (const Thing& each : things) {
    landmarks.push_back(each.landmark);
    labels.push_back(each.label);
    size += each.landmark.width();
  }
  slam.setMap({}, landmarks, labels, sigma * sigma * MatrixXd::Identity(size, size));
  return slam;
}

inline void expectPose(const LandmarkSlam& slam, const Pose2& pose, double metres) {
  EXPECT_LT((slam.filter().pose().position - pose.position).norm(), metres);
  EXPECT_NEAR(wrapped(slam.filter().pose().heading - pose.heading), 0, metres);
}

}  // namespace sextant
