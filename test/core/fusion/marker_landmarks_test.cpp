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
        markerObservations({{kKey, T_camera_marker, noiseOfPose()}}, T_base_camera, params)[0];
    const Matrix3d drawn = drawnCovariance(T_base_camera, T_camera_marker, noiseOfPose(), params.tilt_sigma);
    EXPECT_LT((found.observation.covariance - drawn).norm(), 0.02 * drawn.norm()) << drawn;
    EXPECT_NEAR(found.observation.covariance(2, 2), drawn(2, 2), 0.02 * drawn(2, 2));
    EXPECT_LT((found.observation.position - T_base_marker.translation().head<2>()).norm(), 1e-12);
    EXPECT_NEAR(*found.observation.heading, headingOf(T_base_marker.linear()), 1e-12);
    EXPECT_EQ(found.label, (LandmarkLabel{"tag36h11", 7}));
    EXPECT_TRUE(found.can_initialize);
  }
}

/// A robot on ramps whose slopes are as drawn, in front of one marker or two.
class OnRamps {
 public:
  OnRamps(double ramp_sigma, int markers) : markers_(markers) {
    params_.tilt_sigma = 0.005;
    params_.ramp_sigma = ramp_sigma;
  }

  /// Error of (x, y, heading) of the observation of the first marker. @param sum to which its covariance is
  /// added @param turn of the markers in their planes, which the map does not have, radians
  Vector3d error(bool is_mapped, Matrix3d& sum, double alternative_probability = 0, double turn = 0) {
    const double slope = std::hypot(params_.tilt_sigma, params_.ramp_sigma);
    const Pose T_level_base(expSO3(slope * Vector3d{noise_(random_), noise_(random_), 0}));
    MarkerMap map;
    std::vector<SeenMarker> seen;
    for (int i = 0; i < markers_; ++i) {
      const MarkerKey key{"tag36h11", i};
      const Matrix6d of_map = 0.09 * noiseOfPose();
      map.add({key, 0.2, "", perturbed(T_map_level_ * T_level_marker_[i], 0.3 * drawn()), of_map});
      const Pose T_camera_marker =
          (T_level_base * kMount).inverse() * T_level_marker_[i] * poseFromXyzRpy({0, 0, 0}, {0, 0, turn});
      seen.push_back({key, perturbed(T_camera_marker, drawn()), noiseOfPose(), alternative_probability});
    }
    const Observation2D found =
        markerObservations(seen, kMount, params_, is_mapped ? &map : nullptr)[0].observation;
    sum += found.covariance;
    Vector3d error;
    error << T_level_marker_[0].translation().head<2>() - found.position,
        wrapped(headingOf(T_level_marker_[0].linear()) - found.heading.value_or(0));
    return error;
  }

 private:
  Vector6d drawn() {
    return root_ * Vector6d::NullaryExpr([&](auto) { return noise_(random_); });
  }

  inline static const Pose kMount = poseFromXyzRpy({0.1, 0.02, 0.4}, {-M_PI_2 - 0.2, 0.05, -M_PI_2 + 0.3});
  int markers_;
  MarkerLandmarkParams params_;
  const std::vector<Pose> T_level_marker_ = {markerOnWall({2, 0.5, 2.4}, 0.4),
                                             markerOnWall({4, -1, 1.5}, -0.4)};
  const Pose T_map_level_ = poseFromXyzRpy({5, -3, 0.7}, {0, 0, 2});
  const Matrix6d root_ = noiseOfPose().llt().matrixL();
  std::mt19937 random_{3};
  std::normal_distribution<double> noise_{0, 1};
};

/// Standard deviation of the position, after its check and that of the heading.
double checkedSigma(int markers, bool is_mapped) {
  OnRamps robot(0.08, markers);
  Matrix3d scatter = Matrix3d::Zero(), stated = Matrix3d::Zero();
  const int count = 10000;
  for (int i = 0; i < count; ++i) {
    const Vector3d error = robot.error(is_mapped, stated);
    scatter += error * error.transpose();
  }
  EXPECT_LT((scatter - stated).norm(), 0.08 * scatter.norm()) << scatter / count << "\n" << stated / count;
  EXPECT_NEAR(scatter(2, 2), stated(2, 2), 0.15 * stated(2, 2));
  return std::sqrt(scatter.topLeftCorner<2, 2>().trace() / count);
}

TEST(MarkerLandmarks, MappedMarkersMeasureTheSlopeOfARamp) {
  const double alone = checkedSigma(1, false), one = checkedSigma(1, true), two = checkedSigma(2, true);
  EXPECT_GT(alone, 0.2);  // 0.08 rad, 2.4 m above the base
  EXPECT_LT(one, 0.3 * alone);
  EXPECT_LT(two, 0.7 * one);  // the direction from one to the other
}

TEST(MarkerLandmarks, TheMapIsNotUsedWithoutRampsForAnAmbiguousMarkerOrOneThatHangsOtherwise) {
  struct Case {
    double ramp_sigma, alternative, turn;
  };
  for (const Case& each : {Case{0, 0, 0}, {0.08, 0.5, 0}, {0.08, 0, M_PI}, {0.08, 0, 1}}) {
    OnRamps one(each.ramp_sigma, 1), other(each.ramp_sigma, 1);
    Matrix3d mapped = Matrix3d::Zero(), alone = Matrix3d::Zero();
    EXPECT_EQ(one.error(true, mapped, each.alternative, each.turn),
              other.error(false, alone, each.alternative, each.turn));
    EXPECT_EQ(mapped, alone);
  }
}

TEST(MarkerLandmarks, AnAmbiguousMarkerHasNoHeadingAndCannotInitialize) {
  const MarkerLandmarkParams params;
  const Pose mount = forwardMount(0.5);
  const auto at = [&](double other) {
    const Pose T_camera_marker = mount.inverse() * markerOnWall({2, 0, 1});
    return markerObservations({{kKey, T_camera_marker, noiseOfPose(), other}}, mount, params)[0];
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
