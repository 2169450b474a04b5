// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/pose_posterior.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "sextant/markers/marker_pose.hpp"
#include "test_cameras.hpp"
#include "test_observations.hpp"

namespace sextant {
namespace {

const Pose kMount = forwardMount(1.0);
constexpr double kRegion6 = 12.59, kRegion3 = 7.815;  // chi-square, 95 %

// Statistics of a series of published poses.
struct Consistency {
  int frames = 0, decided = 0, inside = 0, position_inside = 0;
  double decided_nees = 0, nees = 0;

  void add(const Pose& truth, const Pose& estimate, const PosePosterior& posterior, bool certain) {
    const Vector6d e = poseError(truth, estimate);
    const double d2 = e.dot(posterior.covariance.ldlt().solve(e));
    const Eigen::Vector3d p = e.head<3>();
    ++frames;
    decided += certain;
    inside += d2 < kRegion6;
    position_inside += p.dot(posterior.covariance.topLeftCorner<3, 3>().ldlt().solve(p)) < kRegion3;
    nees += d2;
    if (certain) decided_nees += d2;
  }
};

// Robots that look at the markers from anywhere within 1 rad of head-on.
Consistency simulate(const std::vector<Pose>& markers, double farthest, int frames,
                     const std::optional<FloorPrior>& floor) {
  const CameraModel camera(testCalibrations()[1], CameraModel::Image::raw);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> range(0.7, farthest), bearing(-1, 1), aside(-0.15, 0.15);
  std::normal_distribution<double> noise(0, 1);
  Consistency sum;
  while (sum.frames < frames) {
    const double r = range(random), a = bearing(random);
    Pose truth = poseFromXyzRpy({3 - r * std::cos(a), -r * std::sin(a), 0}, {0, 0, a + aside(random)});
    if (floor) {
      const double height = floor->height_sigma * noise(random);
      truth = truth * poseFromXyzRpy({0, 0, height}, {floor->tilt_sigma * noise(random),
                                                      floor->tilt_sigma * noise(random), 0});
    }
    const auto observations = seenFrom(truth, camera, kMount, markers, 0.2, 0.3, random);
    std::vector<InitialPose> initial_poses;
    for (size_t i = 0; i < observations.size(); ++i) {
      const MarkerObservation& observation = observations[i];
      const auto poses = solveMarkerPose(camera, observation.corners, 0.2);
      if (!poses) continue;
      const auto base = [&](const MarkerPose& pose) {
        return observation.T_map_marker * pose.T_camera_marker.inverse() * observation.T_camera_base;
      };
      initial_poses.push_back({base(poses->best), i});
      if (poses->alternative) initial_poses.push_back({base(*poses->alternative), i});
    }
    HypothesesParams params;
    params.floor = floor;
    const auto hypotheses = poseHypotheses(observations, initial_poses, params, std::nullopt);
    if (hypotheses.empty()) continue;
    const PosteriorParams decision{0.999999, floor};
    const auto posterior = posePosterior(observations, hypotheses, decision);
    sum.add(truth, hypotheses[posterior.best].T_map_base, posterior,
            posterior.probability >= decision.min_probability);
  }
  return sum;
}

TEST(PosePosterior, OneMarkersRegionHoldsTheTruth) {
  const auto sum = simulate({markerOnWall({3, 0, 1})}, 6, 1500, std::nullopt);
  EXPECT_GT(sum.inside, 0.93 * sum.frames);
  EXPECT_LT(sum.inside, 0.97 * sum.frames);
  EXPECT_GT(sum.position_inside, 0.93 * sum.frames);
  EXPECT_LT(sum.position_inside, 0.975 * sum.frames);
  EXPECT_NEAR(sum.decided_nees / sum.decided, 6.0, 0.6);
  EXPECT_GT(sum.decided, 0.2 * sum.frames);
  EXPECT_LT(sum.decided, 0.8 * sum.frames);
}

TEST(PosePosterior, CoplanarMarkersAreConsistent) {
  const auto sum = simulate({markerOnWall({3, -0.3, 1}), markerOnWall({3, 0.3, 1.1})}, 5, 600, std::nullopt);
  EXPECT_GT(sum.decided, 0.9 * sum.frames);
  EXPECT_NEAR(sum.decided_nees / sum.decided, 6.0, 0.6);
}

TEST(PosePosterior, FloorAndOneMarkerAreConsistent) {
  const auto sum = simulate({markerOnWall({3, 0, 1})}, 6, 1000, FloorPrior{0.01, 0.01});
  EXPECT_NEAR(sum.decided_nees / sum.decided, 6.0, 0.7);
  EXPECT_NEAR(sum.nees / sum.frames, 6.0, 0.8);
}

// From afar the bearing of the markers is so accurate that a shift along a rotated line of sight matters.
TEST(PosePosterior, FloorAndFarCoplanarMarkersAreConsistent) {
  const auto sum =
      simulate({markerOnWall({3, -0.8, 1.2}), markerOnWall({3, 0, 1.2}), markerOnWall({3, 0.8, 1.2})}, 10,
               800, FloorPrior{0.01, 0.01});
  EXPECT_GT(sum.decided, 0.98 * sum.frames);
  EXPECT_NEAR(sum.decided_nees / sum.decided, 6.0, 0.4);
}

// Three markers support this pose of the base, three others one 2 m aside: a narrow Gaussian at each
// pose.
TEST(PosePosterior, TwoHypothesesAreCoveredTogether) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  std::mt19937 random(8);
  const Pose here = Pose::Identity(), aside = poseFromXyzRpy({0, 2, 0}, {0, 0, 0});
  const auto three = [&](const Pose& T_map_base) {
    return seenFrom(T_map_base, camera, kMount,
                    {T_map_base * markerOnWall({2, 0.4, 1}, 0.3), T_map_base * markerOnWall({2.5, -0.6, 1.2}),
                     T_map_base * markerOnWall({1.8, 0, 0.9}, -0.5)},
                    0.2, 0.1, random);
  };
  auto observations = three(here);
  for (const MarkerObservation& observation : three(aside)) observations.push_back(observation);
  auto hypotheses = poseHypotheses(observations, {{here, 0}, {aside, 3}}, {}, std::nullopt);
  ASSERT_EQ(hypotheses.size(), 2u);
  hypotheses[0].weight = 0.6;
  hypotheses[1].weight = 0.4;
  const auto open = posePosterior(observations, hypotheses, {});
  EXPECT_EQ(open.best, 0u);
  EXPECT_DOUBLE_EQ(open.probability, 0.6);
  const double way = hypotheses[1].T_map_base.translation().y() - hypotheses[0].T_map_base.translation().y();
  EXPECT_GE(open.covariance(1, 1), 0.4 * way * way);
  EXPECT_LT(open.covariance(1, 1), 0.4 * way * way * 1.5);  // a factor for the region
  EXPECT_LT(open.covariance(0, 0), 0.01);
  hypotheses[0].weight = 0.99995;
  hypotheses[1].weight = 0.00005;
  const auto certain = posePosterior(observations, hypotheses, {});
  EXPECT_LT(certain.covariance(1, 1), 0.01);
}

// One pose of 85 % and three of 5 % each, 2 m off along x, y and z: the second moment alone leaves these
// three outside of its region.
TEST(PosePosterior, TheRegionOfAnUndecidedPoseHoldsAtLeast92Percent) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  std::mt19937 random(8);
  std::vector<MarkerObservation> observations;
  std::vector<InitialPose> initial_poses;
  const Pose offsets[] = {Pose::Identity(), poseFromXyzRpy({2, 0, 0}, {0, 0, 0}),
                          poseFromXyzRpy({0, 2, 0}, {0, 0, 0}), poseFromXyzRpy({0, 0, 2}, {0, 0, 0})};
  for (const Pose& T_map_base : offsets) {
    initial_poses.push_back({T_map_base, observations.size()});
    for (const MarkerObservation& observation :
         seenFrom(T_map_base, camera, kMount,
                  {T_map_base * markerOnWall({2, 0.4, 1}, 0.3), T_map_base * markerOnWall({2.5, -0.6, 1.2}),
                   T_map_base * markerOnWall({1.8, 0, 0.9}, -0.5)},
                  0.2, 0.1, random))
      observations.push_back(observation);
  }
  auto hypotheses = poseHypotheses(observations, initial_poses, {}, std::nullopt);
  ASSERT_EQ(hypotheses.size(), 4u);
  for (size_t i = 0; i < 4; ++i) hypotheses[i].weight = i == 0 ? 0.85 : 0.05;
  const auto posterior = posePosterior(observations, hypotheses, {});
  ASSERT_EQ(posterior.best, 0u);
  const Eigen::LDLT<Matrix6d> region(posterior.covariance);
  std::normal_distribution<double> normal(0, 1);
  double held = 0;
  constexpr int kSamples = 20000;
  for (const PoseHypothesis& found : hypotheses) {
    const Vector6d mean = poseError(found.T_map_base, hypotheses[0].T_map_base);
    const Matrix6d root = found.covariance.llt().matrixL();
    for (int i = 0; i < kSamples; ++i) {
      const Vector6d e = mean + root * Vector6d::NullaryExpr([&](auto) { return normal(random); });
      if (e.dot(region.solve(e)) < kRegion6) held += found.weight / kSamples;
    }
  }
  EXPECT_GE(held, 0.92);
  EXPECT_LE(held, 0.95);
}

}  // namespace
}  // namespace sextant
