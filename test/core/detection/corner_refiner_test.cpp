// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/detection/corner_refiner.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "test_cameras.hpp"
#include "test_print.hpp"

namespace sextant {
namespace {

const Corners kTruth = {Eigen::Vector2d(50.3, 31.7), {104.2, 40.1}, {99.6, 91.4}, {46.8, 84.9}};
constexpr double kStartSigma = 0.5;
const BorderSquare kSquare = {8, false, kStartSigma};

double worst(const Corners& a, const Corners& b) {
  double distance = 0;
  for (int i = 0; i < 4; ++i) distance = std::max(distance, (a[i] - b[i]).norm());
  return distance;
}

Corners shifted(const Corners& corners, double by) {
  Corners start = corners;
  for (int i = 0; i < 4; ++i) start[i] += by * Eigen::Vector2d(std::cos(2.0 * i), std::sin(2.0 * i));
  return start;
}

// The farthest corner in units of its own deviation.
double worstInSigmas(const RefinedCorners& found) {
  double most = 0;
  for (int i = 0; i < 4; ++i) most = std::max(most, (found.corners[i] - kTruth[i]).norm() / found.sigmas[i]);
  return most;
}

TEST(CornerRefiner, FindsTheTrueCorners) {
  for (const double shift : {0.0, 0.7, 1.4}) {
    const auto quiet =
        refineCorners(photograph(printScene(kTruth), {{160, 120}, 0}), shifted(kTruth, shift), kSquare);
    EXPECT_LT(worst(quiet.corners, kTruth), 0.05) << shift;
    const auto noisy =
        refineCorners(photograph(printScene(kTruth), {{160, 120}, 4}), shifted(kTruth, shift), kSquare);
    EXPECT_LT(worst(noisy.corners, kTruth), 0.15) << shift;
    for (int i = 0; i < 4; ++i) EXPECT_LT(quiet.sigmas[i], noisy.sigmas[i]);
  }
}

TEST(CornerRefiner, WorksOnSquaresThatAreWhiteInside) {
  const cv::Mat negative = 255 - photograph(printScene(kTruth), {});
  const auto found = refineCorners(negative, kTruth, {8, true, kStartSigma});
  EXPECT_LT(worst(found.corners, kTruth), 0.1);
  const auto wrong = refineCorners(negative, kTruth, kSquare);
  for (const double sigma : wrong.sigmas) EXPECT_GE(sigma, kStartSigma);
}

// Squares of every size, tilt, noise and blur, each with a start of its own.
TEST(CornerRefiner, TellsTheNoiseThatItHas) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> half(8, 40), jitter(-2, 2), start(-1, 1), noise(1, 8),
      blur(0.4, 1.2);
  double squares = 0;
  int refined = 0, all = 0;
  for (int k = 0; k < 100; ++k) {
    const double h = half(random);
    Corners truth = {Eigen::Vector2d(80 - h, 60 - h), {80 + h, 60 - h}, {80 + h, 60 + h}, {80 - h, 60 + h}};
    for (auto& corner : truth) corner += Eigen::Vector2d{jitter(random), jitter(random)};
    Corners raw = truth;
    for (auto& corner : raw) corner += Eigen::Vector2d{start(random), start(random)};
    const auto found = refineCorners(
        photograph(printScene(truth), {{160, 120}, noise(random), blur(random), k + 1}), raw, kSquare);
    for (int i = 0; i < 4; ++i, ++all) {
      if (found.sigmas[i] >= kStartSigma) continue;
      squares += 0.5 * (found.corners[i] - truth[i]).squaredNorm() / (found.sigmas[i] * found.sigmas[i]);
      ++refined;
    }
  }
  EXPECT_GT(refined, 0.9 * all);
  EXPECT_NEAR(std::sqrt(squares / refined), 1.0, 0.2);
}

TEST(CornerRefiner, KeepsTheStartWhereAnEdgeIsOccluded) {
  const Scene print = printScene(kTruth);
  const cv::Mat image = photograph([&](const Eigen::Vector2d& p) { return p.x() < 62 ? 0.2 : print(p); }, {});
  const Corners start = shifted(kTruth, 0.4);
  const auto found = refineCorners(image, start, kSquare);
  for (const int occluded : {0, 3}) {
    EXPECT_EQ(found.corners[occluded], start[occluded]);
    EXPECT_GT(found.sigmas[occluded], 2.0);
  }
  for (const int seen : {1, 2}) {
    EXPECT_LT((found.corners[seen] - kTruth[seen]).norm(), 0.1);
    EXPECT_LT(found.sigmas[seen], 0.1);
  }
}

// Something over a corner that leaves more than half of its edges: they meet behind it.
TEST(CornerRefiner, FindsACornerBehindSomethingSmall) {
  const Scene print = printScene(kTruth);
  for (const double grey : {0.0, 0.4, 1.0}) {
    const auto covered = [&](const Eigen::Vector2d& p) {
      return (p - kTruth[1]).norm() < 14 ? grey : print(p);
    };
    Corners start = shifted(kTruth, 0.4);
    start[1] += Eigen::Vector2d(-2.5, 2.5);  // where a contour would cut it off
    const auto found = refineCorners(photograph(covered, {}), start, kSquare);
    EXPECT_LT(worstInSigmas(found), 4) << grey;
  }
}

// A strip along the top edge: light over the border, or dark over the white around it. The edge that is seen
// is not the marker's. (A dark strip of 2.5 px, 0.4 modules, is missed: no step of a bit is left within
// reach.)
TEST(CornerRefiner, DoubtsAnEdgeThatFollowsTheBorder) {
  const Scene print = printScene(kTruth);
  const Eigen::Vector2d along = (kTruth[1] - kTruth[0]).normalized(), inward(-along.y(), along.x());
  for (const double depth : {1.0, 1.5, 4.0})
    for (const double side : {1.0, -1.0}) {
      const auto covered = [&](const Eigen::Vector2d& p) {
        const double from_edge = side * (p - kTruth[0]).dot(inward);
        return from_edge < depth && from_edge > -12 ? (side > 0 ? 1.0 : 0.0) : print(p);
      };
      Corners start = shifted(kTruth, 0.3);
      for (const int i : {0, 1}) start[i] += side * depth * inward;
      const auto found = refineCorners(photograph(covered, {}), start, kSquare);
      EXPECT_LT(worstInSigmas(found), 4) << "depth " << depth << " side " << side;
      for (const int i : {2, 3}) EXPECT_LT((found.corners[i] - kTruth[i]).norm(), 0.15);
    }
}

struct SeenThroughLens {
  cv::Mat image;
  Corners corners;
};

// A large marker near the lower right corner of the image.
SeenThroughLens throughLens(const CameraModel& camera) {
  Eigen::Isometry3d T_camera_marker = Eigen::Isometry3d::Identity();
  T_camera_marker.translation() << 0.26, 0.17, 0.6;
  T_camera_marker.linear() = (Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()) *
                              Eigen::AngleAxisd(M_PI - 0.2, Eigen::Vector3d::UnitX()))
                                 .toRotationMatrix();
  constexpr double kSize = 0.24;
  const auto place = [&](const Eigen::Vector2d& pixel) -> std::optional<Eigen::Vector2d> {
    const auto ray = camera.unproject(pixel);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d normal = T_camera_marker.linear().col(2);
    const double far = T_camera_marker.translation().dot(normal) / ray->dot(normal);
    const Eigen::Vector3d p = T_camera_marker.inverse() * (far * *ray);
    return Eigen::Vector2d(0.5 + p.x() / kSize, 0.5 - p.y() / kSize);
  };
  SeenThroughLens seen;

  seen.image = photograph(printScene(place), {{640, 480}, 2, 0.7, 6, 3});
  for (int i = 0; i < 4; ++i) seen.corners[i] = *camera.project(T_camera_marker * markerCorners(kSize)[i]);
  return seen;
}

TEST(CornerRefiner, FollowsTheLens) {
  for (const CameraCalibration& calibration : testCalibrations()) {
    const CameraModel camera(calibration, CameraModel::Image::raw);
    const SeenThroughLens seen = throughLens(camera);
    const Corners start = shifted(seen.corners, 0.7);
    const auto with = refineCorners(seen.image, start, kSquare, &camera);
    const auto without = refineCorners(seen.image, start, kSquare);
    EXPECT_LT(worst(with.corners, seen.corners), 0.06) << calibration.distortion_model;
    EXPECT_LT(worst(without.corners, seen.corners), 0.4) << calibration.distortion_model;
    EXPECT_LT(worst(with.corners, seen.corners), worst(without.corners, seen.corners) + 0.02);
  }
}

// The marker is cut off by the image border: with a known lens, its other edges determine the occluded one.
TEST(CornerRefiner, FindsAnEdgeThatIsCutOffByTheOthersAndTheLens) {
  for (const CameraCalibration& calibration : testCalibrations()) {
    const CameraModel camera(calibration, CameraModel::Image::raw);
    const SeenThroughLens seen = throughLens(camera);
    const double right = std::min(seen.corners[1].x(), seen.corners[2].x()) - 3;
    const cv::Mat image = seen.image.colRange(0, static_cast<int>(right)).clone();
    Corners start = shifted(seen.corners, 0.5);
    for (const int i : {1, 2}) start[i].x() = right - 4;
    const auto with = refineCorners(image, start, kSquare, &camera);
    const auto without = refineCorners(image, start, kSquare);
    for (const int i : {1, 2}) {
      const double error = (with.corners[i] - seen.corners[i]).norm();
      EXPECT_LT(error, 1.0) << calibration.distortion_model;
      EXPECT_LT(error, 4 * with.sigmas[i]) << calibration.distortion_model;
      EXPECT_LT(with.sigmas[i], 1.0) << calibration.distortion_model;
      EXPECT_GT(without.sigmas[i], 2.0) << calibration.distortion_model;
    }
  }
}

TEST(CornerRefiner, SaysSomethingSensibleOfBlurredAndTinyMarkers) {
  const Corners tiny = {Eigen::Vector2d(70.2, 50.1), {83.1, 50.9}, {82.4, 63.7}, {69.7, 62.8}};
  for (const double blur : {0.5, 1.0, 1.5}) {
    const auto found = refineCorners(photograph(printScene(tiny), {{160, 120}, 3, blur}), tiny, kSquare);
    EXPECT_LT(worst(found.corners, tiny), 1.0) << blur;
    for (const double sigma : found.sigmas) EXPECT_GT(sigma, 0.02) << blur;
  }
  const auto blurred = refineCorners(photograph(printScene(kTruth), {{160, 120}, 3, 3.0}), kTruth, kSquare);
  EXPECT_LT(worstInSigmas(blurred), 4);
}

TEST(CornerRefiner, KeepsTheStartWhereThereIsNothing) {
  for (const cv::Mat& image :
       {cv::Mat(120, 160, CV_8UC1, cv::Scalar(128)), cv::Mat(4, 4, CV_8UC1, cv::Scalar(0))}) {
    const auto found = refineCorners(image, kTruth, kSquare);
    EXPECT_EQ(found.corners, kTruth);
    for (const double sigma : found.sigmas) EXPECT_GE(sigma, kStartSigma);
  }
}

}  // namespace
}  // namespace sextant
