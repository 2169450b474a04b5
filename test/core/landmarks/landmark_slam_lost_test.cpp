// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
// LandmarkSlam where the robot is elsewhere than it thinks.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sextant/landmarks/landmark_slam.hpp"
#include "test_landmarks.hpp"

namespace sextant {
namespace {

// Put elsewhere, it drives on an arc, sees what is not where it should be, and finds itself again.
void expectFoundAgain(LandmarkSlam& slam, const std::vector<Thing>& things, Pose2 robot, int lost_after) {
  const Pose2 motion{{0.1, 0}, 0.05};
  const size_t known = slam.labels().size();
  bool was_lost = false;
  for (int i = 0; i < 60; ++i) {
    if (i > 0) robot = robot * motion, slam.predict({motion, 1e-6 * Matrix3d::Identity(), 0.1}, 0.1);
    const LandmarkReport report = slam.see(0.1 * i, allSeen(robot, things));
    EXPECT_EQ(report.lost, slam.isLost()) << i;
    EXPECT_FALSE(i + 1 < lost_after && slam.isLost()) << i;
    was_lost = was_lost || slam.isLost();
  }
  EXPECT_TRUE(was_lost);
  EXPECT_FALSE(slam.isLost());
  EXPECT_EQ(slam.labels().size(), known);
  expectPose(slam, robot, 0.05);
}

TEST(LandmarkSlam, AKidnappedRobotFindsItselfAmongMarkers) {
  const std::vector<Thing> things{tag(1, 2, 0, 3), tag(2, 3, 1.5, -2), tag(3, 6, -2, 1), tag(4, 5, 3, 0)};
  LandmarkSlamParams impatient = params();
  impatient.lost_after = 4;
  LandmarkSlam slam = knowing(things, impatient);
  slam.see(0, allSeen({}, things));
  expectFoundAgain(slam, things, {{3, 0.2}, 1.2}, 4);
}

TEST(LandmarkSlam, AKidnappedRobotFindsItselfAmongPillars) {
  const std::vector<Thing> things{pillar(2, 0),        pillar(4, 1.5, kBlue), pillar(6, -2),
                                  pillar(5, 3, kBlue), pillar(0, 3.3),        pillar(-2, 1, kBlue)};
  for (const bool read_only : {false, true}) {
    LandmarkSlamParams fixed = params();
    fixed.read_only = read_only;
    LandmarkSlam slam = knowing(things, fixed);
    slam.lose();
    EXPECT_TRUE(slam.isLost());
    expectFoundAgain(slam, things, {{3, 0.2}, 1.2}, 0);
  }
}

}  // namespace
}  // namespace sextant
