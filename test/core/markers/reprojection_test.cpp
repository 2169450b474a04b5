// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/reprojection.hpp"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "test_cameras.hpp"
#include "test_observations.hpp"

namespace sextant {
namespace {

const Pose kMount = forwardMount(0.9);
const Pose kTruth = poseFromXyzRpy({0.4, -0.3, 0.1}, {0.03, -0.02, 0.1});
const std::vector<Pose> kMarkers = {markerOnWall({3, 0.5, 1.2}), markerOnWall({3.2, -0.6, 0.9}, 0.2),
                                    markerOnWall({2.5, 1.0, 1.0}, -0.4)};

std::vector<MarkerObservation> observations(const CameraModel& camera, double sigma, int seed) {
  std::mt19937 random(seed);
  return seenFrom(kTruth, camera, kMount, kMarkers, 0.25, sigma, random);
}

// Independent implementation of a marker's whitened residuals, for Ceres with numeric derivatives.
struct MarkerResiduals {
  const MarkerObservation& observation;
  const Pose& start;
  Eigen::Matrix<double, 8, 8> whitening;

  bool operator()(const double* xi, double* residuals) const {
    const Pose T_map_base = perturbed(start, Eigen::Map<const Vector6d>(xi));
    const Pose T_camera_marker = observation.T_camera_base * T_map_base.inverse() * observation.T_map_marker;
    Eigen::Matrix<double, 8, 1> all;
    for (int k = 0; k < 4; ++k) {
      const auto pixel = observation.camera->project(T_camera_marker * markerCorners(observation.size)[k]);
      if (!pixel) return false;
      all.segment<2>(2 * k) = *pixel - observation.corners[k];
    }
    Eigen::Map<Eigen::Matrix<double, 8, 1>> out(residuals);
    out = whitening * all;
    return true;
  }
};

struct CeresFit {
  Pose T_map_base;
  double cost;
  Matrix6d covariance;
};

CeresFit minimizeWithCeres(const std::vector<MarkerObservation>& all, const Pose& start, double huber) {
  Vector6d xi = Vector6d::Zero();
  ceres::Problem problem;
  for (const MarkerObservation& observation : all) {
    Eigen::Matrix<double, 8, 8> whitening = Eigen::Matrix<double, 8, 8>::Zero();
    for (int i = 0; i < 8; ++i) whitening(i, i) = 1 / observation.sigmas[i / 2];
    problem.AddResidualBlock(new ceres::NumericDiffCostFunction<MarkerResiduals, ceres::CENTRAL, 8, 6>(
                                 new MarkerResiduals{observation, start, whitening}),
                             huber > 0 ? new ceres::HuberLoss(huber) : nullptr, xi.data());
  }
  ceres::Solver::Options options;
  options.function_tolerance = options.parameter_tolerance = options.gradient_tolerance = 1e-15;
  options.max_num_iterations = 200;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ceres::Covariance::Options covariance_options;
  covariance_options.apply_loss_function = false;
  ceres::Covariance covariance(covariance_options);
  const std::vector<std::pair<const double*, const double*>> blocks = {{xi.data(), xi.data()}};
  EXPECT_TRUE(covariance.Compute(blocks, &problem));
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> block;
  covariance.GetCovarianceBlock(xi.data(), xi.data(), block.data());
  return {perturbed(start, xi), 2 * summary.final_cost, block};
}

TEST(Reprojection, FindsTheMinimumAndTheCovarianceThatCeresFinds) {
  for (const auto& calibration : testCalibrations()) {
    const CameraModel camera(calibration, CameraModel::Image::raw);
    auto all = observations(camera, 0.5, 11);
    all[0].sigmas = {0.2, 0.4, 1.0, 3.0};
    const Pose start = perturbed(kTruth, (Vector6d() << 0.1, -0.08, 0.05, 0.02, -0.03, 0.05).finished());
    const auto fit = minimizeReprojection(all, start, {});
    const CeresFit ceres = minimizeWithCeres(all, start, 0);
    ASSERT_TRUE(fit);
    EXPECT_LT(poseError(ceres.T_map_base, fit->T_map_base).norm(), 1e-6);
    EXPECT_NEAR(fit->cost, ceres.cost, 1e-6 * ceres.cost);
    const CeresFit there = minimizeWithCeres(all, fit->T_map_base, 0);  // rotations about the same pose
    EXPECT_LT((fit->information * there.covariance - Matrix6d::Identity()).norm(), 1e-3);
  }
}

TEST(Reprojection, RobustMinimumIsThatOfCeres) {
  const CameraModel camera(testCalibrations()[1], CameraModel::Image::raw);
  auto all = observations(camera, 0.2, 13);
  for (auto& corner : all[1].corners) corner += Eigen::Vector2d(9, -7);
  const auto fit = minimizeReprojection(all, kTruth, {3.0, std::nullopt});
  const CeresFit ceres = minimizeWithCeres(all, kTruth, 3.0);
  ASSERT_TRUE(fit);
  EXPECT_LT(poseError(ceres.T_map_base, fit->T_map_base).norm(), 1e-5);
  EXPECT_NEAR(fit->cost, ceres.cost, 1e-6 * ceres.cost);
}

TEST(Reprojection, ModelIsTheExpansionOfTheCost) {
  const CameraModel camera(testCalibrations()[5], CameraModel::Image::raw);
  const ReprojectionParams params{1e9, FloorPrior{0.05, 0.02}};
  const auto all = observations(camera, 0.3, 12);
  const auto fit = minimizeReprojection(all, kTruth, params);
  ASSERT_TRUE(fit);
  const double h = 1e-4;
  const auto cost = [&](const Vector6d& xi) {
    return reprojectionModel(all, perturbed(fit->T_map_base, xi), params).cost;
  };
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = h * Vector6d::Unit(i);
    const double curvature = (cost(step) + cost(-step) - 2 * fit->cost) / (2 * h * h);
    EXPECT_NEAR(curvature / fit->information(i, i), 1.0, 0.02)
        << i;  // Gauss-Newton leaves second derivatives out
    EXPECT_NEAR((cost(step) - cost(-step)) / (2 * h) / fit->information(i, i), 0.0, 1e-6) << i;
  }
}

// At 2.5 m, 1 mrad of a marker's rotation moves its corners little, 10 mm of its position a lot.
TEST(Reprojection, MapCovarianceIsNoiseOfTheWholeMarker) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  std::mt19937 random(15);
  std::normal_distribution<double> noise(0, 1);
  Matrix6d map_covariance = Matrix6d::Zero();
  map_covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6;
  const int n = 400;
  double nees = 0;
  for (int i = 0; i < n; ++i) {
    auto all = observations(camera, 0.2, 100 + i);
    for (auto& observation : all) {
      observation.map_covariance = map_covariance;
      Vector6d xi;
      for (int k = 0; k < 6; ++k) xi[k] = std::sqrt(map_covariance(k, k)) * noise(random);
      observation.T_map_marker = perturbed(observation.T_map_marker, xi);  // where the map has it
    }
    const auto fit = minimizeReprojection(all, kTruth, {});
    ASSERT_TRUE(fit);
    const Vector6d error = poseError(kTruth, fit->T_map_base);
    nees += error.dot(fit->information * error) / n;
  }
  EXPECT_NEAR(nees, 6.0, 0.6);  // sqrt(12 / 400) = 0.17 a deviation
}

TEST(Reprojection, FloorHoldsHeightRollAndPitch) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  std::mt19937 random(16);
  const Pose truth = poseFromXyzRpy({0.4, -0.3, 0}, {0, 0, 0.1});
  const auto all = seenFrom(truth, camera, kMount, {kMarkers[0]}, 0.25, 0.3, random);
  const auto fit = minimizeReprojection(all, truth, {1e9, FloorPrior{1e-4, 1e-4}});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->T_map_base.translation().z(), 0, 5e-4);
  EXPECT_LT(fit->T_map_base.linear().col(2).head<2>().norm(), 5e-4);
  EXPECT_DOUBLE_EQ(squaredMahalanobis(FloorPrior{0.1, 0.2}, poseFromXyzRpy({1, 2, 0.3}, {0, 0, 2})), 9.0);
  EXPECT_NEAR(squaredMahalanobis(FloorPrior{0.1, 0.2}, poseFromXyzRpy({0, 0, 0}, {0.4, 0, 1})),
              std::pow(std::sin(0.4) / 0.2, 2), 1e-12);
}

TEST(Reprojection, SquaredMahalanobisIsChiSquareOfEightAtTheTruth) {
  const CameraModel camera(testCalibrations()[1], CameraModel::Image::raw);
  double sum = 0;
  for (int i = 0; i < 300; ++i)
    for (const auto& observation : observations(camera, 0.7, 500 + i))
      sum += squaredMahalanobis(observation, kTruth);
  EXPECT_NEAR(sum / 900, 8.0, 0.5);  // sqrt(16 / 900) = 0.13 a deviation
  const auto behind = observations(camera, 0.7, 1)[0];
  EXPECT_GT(squaredMahalanobis(behind, poseFromXyzRpy({5, 0, 0}, {0, 0, 0})), 1e12);
}

TEST(Reprojection, TellsNothingWhereThePoseIsFree) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  auto point = observations(camera, 0.0, 14);
  point.resize(1);
  point[0].size = 1e-9;  // one point of a marker: two numbers for six unknowns
  EXPECT_FALSE(minimizeReprojection(point, kTruth, {}));
  EXPECT_FALSE(minimizeReprojection({}, kTruth, {}));
}

TEST(Pivot, JacobianIsThatOfTheMove) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const Pivot pivot(observations(camera, 0.1, 1));
  const double h = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const Vector6d difference = poseError(pivot.moved(kTruth, h * Vector6d::Unit(i)), kTruth) / h;
    EXPECT_LT((difference - pivot.jacobian(kTruth).col(i)).norm(), 1e-5) << i;
  }
  Vector6d turn = Vector6d::Zero();
  turn.tail<3>() << 0.3, -0.5, 1.0;
  const Pose turned = pivot.moved(kTruth, turn);
  // The centre keeps its place in the base's frame.
  EXPECT_LT((turned.inverse() * pivot.centre() - kTruth.inverse() * pivot.centre()).norm(), 1e-12);
}

}  // namespace
}  // namespace sextant
