// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/marker_landmarks.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "test_matrices.hpp"
#include "test_observations.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

const MarkerKey kKey{"tag36h11", 7};

/// A print on the floor, its lower edge toward a heading.
Pose markerOnFloor(const Vector3d& position, double heading) {
  return Eigen::Translation3d(position) * Pose(Eigen::AngleAxisd(heading + M_PI_2, Vector3d::UnitZ()));
}

/// Of T_camera_marker, every axis another one and all of them correlated.
Matrix6d noiseOfPose() {
  srand(1);
  const Matrix6d A = Matrix6d::Random() + 2 * Matrix6d::Identity();
  Matrix6d scale = Matrix6d::Zero();
  scale.diagonal() << 0.003, 0.002, 0.006, 0.004, 0.005, 0.003;
  return scale * A * A.transpose() * scale;
}

TEST(MarkerLandmarks, HeadingOfAPrintOnAWallIsItsNormal) {
  for (const double yaw : {0.0, 0.7, -2.0})  // markerOnWall looks along -x
    EXPECT_NEAR(wrapped(headingOf(markerOnWall({3, 1, 1}, yaw).linear()) - (M_PI + yaw)), 0, 1e-12);
  for (const double lean : {-1.5, -0.786, -0.785, 0.785, 0.786, 1.5}) {  // also about 45 degrees
    const Matrix3d leaning = expSO3({0, lean, 0}) * markerOnWall({3, 1, 1}).linear();
    EXPECT_NEAR(std::abs(headingOf(leaning)), M_PI, 1e-12) << lean;
  }
}

TEST(MarkerLandmarks, HeadingOfARotatedPrintIsItsNormal) {
  for (const double turn : {-2.0, -0.8, 0.3, 0.8, M_PI_2, 2.0}) {
    const Matrix3d turned = markerOnWall({3, 1, 1}, 0.5).linear() * expSO3({0, 0, turn});
    EXPECT_NEAR(wrapped(headingOf(turned) - (M_PI + 0.5)), 0, 1e-12) << turn;
  }
}

TEST(MarkerLandmarks, HeadingOfAPrintOnFloorOrCeilingIsAcrossItsLowerEdge) {
  for (const double heading : {0.0, 1.0, -3.0})
    EXPECT_NEAR(headingOf(markerOnFloor({1, 2, 0}, heading).linear()), heading, 1e-12);
  const Matrix3d ceiling = markerOnFloor({1, 2, 0}, 0.5).linear() * expSO3({M_PI, 0, 0});
  EXPECT_NEAR(headingOf(ceiling), 0.5, 1e-12);
}

/// (x, y, heading) of observations as drawn: of the marker's pose in the camera, and of the robot's tilt.
Matrix3d drawnCovariance(const Pose& T_base_camera, const Pose& T_camera_marker, const Matrix6d& covariance,
                         double tilt) {
  const Matrix6d root = covariance.llt().matrixL();
  const Pose mean = T_base_camera * T_camera_marker;
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 1);
  const auto unit = [&](auto) { return noise(random); };
  Matrix3d scatter = Matrix3d::Zero();
  const int count = 100000;
  for (int i = 0; i < count; ++i) {
    const Vector6d drawn = root * Vector6d::NullaryExpr(unit);
    Pose tilted = Pose::Identity();
    tilted.linear() = expSO3(tilt * Vector3d{noise(random), noise(random), 0});
    const Pose seen = tilted * T_base_camera * perturbed(T_camera_marker, drawn);
    Vector3d off;
    off << (seen.translation() - mean.translation()).head<2>(),
        wrapped(headingOf(seen.linear()) - headingOf(mean.linear()));
    scatter += off * off.transpose() / count;
  }
  return scatter;
}

TEST(MarkerLandmarks, CovarianceIsThatOfSampledPosesAndTilts) {
  const Pose T_base_camera = poseFromXyzRpy({0.1, 0.02, 0.4}, {-M_PI_2 - 0.2, 0.05, -M_PI_2 + 0.3});
  for (const Pose& T_base_marker :
       {Pose(markerOnWall({2, 0.5, 1.4}, 0.4)), markerOnFloor({2, -0.5, 0}, 2.0)}) {
    MarkerLandmarkParams params;
    params.tilt_sigma = 0.01;
    const Pose T_camera_marker = T_base_camera.inverse() * T_base_marker;
    const LabelledObservation found =
        markerObservation(kKey, T_base_camera, T_camera_marker, noiseOfPose(), 0, params);
    const Matrix3d drawn = drawnCovariance(T_base_camera, T_camera_marker, noiseOfPose(), params.tilt_sigma);
    EXPECT_LT((found.observation.covariance - drawn).norm(), 0.02 * drawn.norm()) << drawn;
    EXPECT_NEAR(found.observation.covariance(2, 2), drawn(2, 2), 0.02 * drawn(2, 2));
    EXPECT_LT((found.observation.position - T_base_marker.translation().head<2>()).norm(), 1e-12);
    EXPECT_NEAR(*found.observation.heading, headingOf(T_base_marker.linear()), 1e-12);
    EXPECT_EQ(found.label, (LandmarkLabel{"tag36h11", 7}));
    EXPECT_TRUE(found.can_initialize);
  }
}

TEST(MarkerLandmarks, AnAmbiguousMarkerHasNoHeadingAndCannotInitialize) {
  const MarkerLandmarkParams params;
  const Pose mount = forwardMount(0.5);
  const auto at = [&](double other) {
    return markerObservation(kKey, mount, mount.inverse() * markerOnWall({2, 0, 1}), noiseOfPose(), other,
                             params);
  };
  EXPECT_TRUE(at(0.9e-4).observation.heading);
  EXPECT_TRUE(at(0.9e-4).can_initialize);
  const LabelledObservation ambiguous = at(1.1e-4);
  EXPECT_FALSE(ambiguous.observation.heading);
  EXPECT_FALSE(ambiguous.can_initialize);
  EXPECT_EQ(ambiguous.observation.position, at(0).observation.position);
  EXPECT_EQ(ambiguous.observation.covariance, at(0).observation.covariance);
}

TEST(MarkerLandmarks, AlternativePoseProbabilityIsTheLikelihoodRatio) {
  EXPECT_DOUBLE_EQ(alternativePoseProbability(0.2, 0.2, 0.3), 0.5);
  // Two normal densities of eight residuals each.
  const auto density = [](double rms) { return std::exp(-8 * rms * rms / (2 * 0.3 * 0.3)); };
  EXPECT_NEAR(alternativePoseProbability(0.2, 0.5, 0.3), density(0.5) / (density(0.2) + density(0.5)), 1e-15);
}

TEST(MarkerLandmarks, AMapOfMarkersAsLandmarks) {
  MarkerMap map;
  const Matrix6d covariance = noiseOfPose();
  map.add({{"tag36h11", 7}, 0.2, "", markerOnFloor({1, 2, 0}, 0.7), covariance});
  map.add({{"tag36h11", 8}, 0.2, "", markerOnWall({3, -1, 1.2}, 0.4), Matrix6d::Zero()});
  const MarkerLandmarks found = landmarksOf(map);
  ASSERT_EQ(found.landmarks.size(), 2u);
  EXPECT_EQ(found.labels[1], (LandmarkLabel{"tag36h11", 8}));
  EXPECT_LT((found.landmarks[1].position - Eigen::Vector2d(3, -1)).norm(), 1e-12);
  EXPECT_NEAR(wrapped(*found.landmarks[1].heading - M_PI - 0.4), 0, 1e-12);
  EXPECT_TRUE((found.covariances[1].llt().info() == Eigen::Success));  // exact ones have a little, too
  EXPECT_LT(found.covariances[1].norm(), 1e-6);

  // On the floor the heading is the rotation about z.
  const std::vector<Eigen::Index> plane{0, 1, 5};
  EXPECT_LT((found.covariances[0] - picked(covariance, plane, plane)).norm(), 1e-7);
}

TEST(MarkerLandmarks, NamesAFieldThatIsOutOfRange) {
  MarkerLandmarkParams params;
  validate(params);
  params.heading_min_probability = 1.1;
  EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }).find("heading_min_probability is "),
            0u);
  params = {};
  params.tilt_sigma = -0.1;
  EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }).find("tilt_sigma is "), 0u);
}

}  // namespace
}  // namespace sextant
