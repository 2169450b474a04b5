// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "sextant/landmarks/landmark_timeline.hpp"

namespace sextant {

using Eigen::Matrix3d;
using Eigen::Vector2d;

inline const Pose2 kStart{{2, 1}, 0.4};

struct Look {
  double stamp;
  std::vector<LabelledSighting> sightings;
};

/// A round trip at 0.5 m/s and 1 rad/s among six landmarks with ids; odometry has its own origin.
struct Drive {
  std::vector<std::pair<double, Pose2>> odometry, truth;  // stamp, pose
  std::vector<Look> looks;
  std::vector<PlaneLandmark> landmarks;
  std::vector<LandmarkLabel> labels;
};

constexpr double kTick = 0.02;
constexpr int kTicks = 1000;

inline Drive drive(int seed) {
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
    drawn.looks.push_back({10 + i * kTick, {}});
    for (size_t k = 0; k < drawn.landmarks.size(); ++k) {
      const Vector2d at = seenFrom(robot, drawn.landmarks[k]).position;
      const Vector2d seen = at + 0.1 * Vector2d(noise(random), noise(random));
      drawn.looks.back().sightings.push_back({drawn.labels[k], {seen, {}, 0.01 * Matrix3d::Identity()}});
    }
  }
  return drawn;
}

inline LandmarkSlam slamOf(const Drive& drive) {
  LandmarkSlam slam({}, kStart, 1e-4 * Matrix3d::Identity());
  const auto size = static_cast<Eigen::Index>(3 + 2 * drive.landmarks.size());
  slam.setMap(kStart, drive.landmarks, drive.labels, 1e-4 * Eigen::MatrixXd::Identity(size, size));
  return slam;
}

inline LandmarkTimeline timelineOf(const Drive& drive, double lag = 1.0, double clock_offset = 0.0) {
  LandmarkTimelineParams params;
  params.lag = lag;
  params.clock_offset = clock_offset;
  return {params, slamOf(drive)};
}

/// All odometry, and each look as late as told. @returns root of the mean squared error of the position
inline double run(LandmarkTimeline& timeline, const Drive& drive, const std::vector<double>& delays) {
  std::vector<std::pair<double, size_t>> arrivals;
  for (size_t k = 0; k < drive.looks.size(); ++k)
    arrivals.emplace_back(drive.looks[k].stamp + delays[k % delays.size()], k);
  std::stable_sort(arrivals.begin(), arrivals.end());
  double squares = 0;
  auto next = arrivals.begin();
  for (size_t i = 0; i < drive.odometry.size(); ++i) {
    EXPECT_TRUE(timeline.odometry(drive.odometry[i].first, drive.odometry[i].second));
    for (; next != arrivals.end() && next->first < drive.odometry[i].first + kTick / 2; ++next)
      EXPECT_EQ(timeline.see(drive.looks[next->second].stamp, drive.looks[next->second].sightings),
                Arrival::taken);
    squares += (timeline.now()->T_map_base.position - drive.truth[i].second.position).squaredNorm();
  }
  for (; next != arrivals.end(); ++next)
    timeline.see(drive.looks[next->second].stamp, drive.looks[next->second].sightings);
  return std::sqrt(squares / drive.odometry.size());
}

}  // namespace sextant
