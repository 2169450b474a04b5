// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/error_monitor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <random>

#include "sextant/localization/marker_localization.hpp"
#include "test_cameras.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

constexpr double kNoise = 0.1;  // pixels

/// What is, and what the locator is given.
struct FaultyRoom {
  CameraCalibration true_camera = calibration();
  double readout_time = 0;  // seconds
  double true_size = 0.2;   // metres
  MarkerMap true_map = hall();

  static CameraCalibration calibration() {
    CameraCalibration camera = testCalibration("plumb_bob", {0, 0, 0, 0, 0});
    camera.width = 1280;
    camera.height = 720;
    camera.K << 700, 0, 639.5, 0, 700, 359.5, 0, 0, 1;
    return camera;
  }

  /// Twelve markers on the walls of a square room of 6 m, facing its middle.
  static MarkerMap hall() {
    MarkerMap map;
    for (int id = 0; id < 12; ++id) {
      const double yaw = M_PI_2 * (id % 4), along = 1.7 * (id / 4 - 1) + 0.3 * (id % 4),
                   up = 0.7 + 0.25 * (id % 4);
      const Pose T_map_marker =
          poseFromXyzRpy({0, 0, 0}, {0, 0, yaw}) * poseFromXyzRpy({3, along, up}, {M_PI_2, 0, -M_PI_2});
      map.add({{kFamily, id}, 0.2, "", T_map_marker, Matrix6d::Zero()});
    }
    return map;
  }

  void move(int id, const Eigen::Vector3d& offset) {
    MappedMarker marker = *true_map.find({kFamily, id});
    marker.T_map_marker.translation() += offset;
    true_map.set(marker);
  }
};

Pose robotAt(double time) {
  return poseFromXyzRpy({1.2 * std::cos(0.35 * time), 1.2 * std::sin(0.47 * time), 0},
                        {0, 0, 0.6 * time + 0.8 * std::sin(0.9 * time)});
}

std::optional<Corners> projected(const FaultyRoom& setup, const CameraModel& camera,
                                 const MappedMarker& marker, double time) {
  Corners corners;
  for (int k = 0; k < 4; ++k) {
    double row_time = time;
    for (int round = 0; round < 4; ++round) {  // the row depends on the time, and the time on the row
      const Pose T_camera_marker = (robotAt(row_time) * kMount).inverse() * marker.T_map_marker;
      const Eigen::Vector3d p = T_camera_marker * markerCorners(setup.true_size)[k];
      const auto pixel = p.z() > 0.4 && p.head<2>().norm() < 1.2 * p.z() ? camera.project(p) : std::nullopt;
      if (!pixel || pixel->x() < 0 || pixel->x() > 1279 || pixel->y() < 0 || pixel->y() > 719)
        return std::nullopt;
      corners[k] = *pixel;
      row_time = time + setup.readout_time * ((pixel->y() + 0.5) / 720 - 0.5);
    }
  }
  return corners;
}

/// A robot that has driven through the room for some images, ten a second.
struct Driven {
  MarkerLocalization localization{LocalizationParams{}};
  int poses = 0, inside = 0;  // of the last quarter of the images

  Driven(const FaultyRoom& setup, int images, int seed = 1) {
    const CameraModel truth(setup.true_camera, CameraModel::Image::raw),
        assumed(FaultyRoom::calibration(), CameraModel::Image::raw);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, kNoise);
    for (int i = 0; i < images; ++i) {
      MarkerView view{assumed, kMount, {}};
      for (const auto& [key, marker] : setup.true_map.markers()) {
        auto corners = projected(setup, truth, marker, 0.1 * i);
        if (!corners) continue;
        for (auto& corner : *corners) corner += Eigen::Vector2d{noise(random), noise(random)};
        Detection detection;
        detection.key = key;
        detection.corners = *corners;
        view.detections.push_back(detection);
      }
      const auto result = localization.locate(FaultyRoom::hall(), {view}, std::nullopt, 0.1 * i);
      if (4 * i < 3 * images || !result.pose) continue;
      const Vector6d e = poseError(robotAt(0.1 * i), result.pose->T_map_base);
      ++poses;
      inside += e.dot(result.pose->covariance.ldlt().solve(e)) < 12.59;  // 95 % of chi-square
    }
  }

  std::vector<SystematicError> errors() const { return localization.errors().errors(); }
};

void expectOnly(const Driven& driven, ErrorCause cause, double value, double tolerance,
                Eigen::Index index = 0) {
  const auto errors = driven.errors();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].cause, cause);
  EXPECT_NEAR(errors[0].value[index], value, tolerance);
  EXPECT_LT(std::abs(errors[0].value[index] - value), 5 * errors[0].sigma[index]);
  EXPECT_GE(driven.inside, 0.9 * driven.poses);
}

TEST(ErrorMonitor, IsSilentWhenEverythingIsRight) {
  for (int seed = 1; seed <= 3; ++seed) EXPECT_TRUE(Driven(FaultyRoom(), 300, seed).errors().empty());
}

TEST(ErrorMonitor, FindsTheFocalLength) {
  FaultyRoom setup;
  setup.true_camera.K.diagonal().head<2>() *= 1.01;
  expectOnly(Driven(setup, 300), ErrorCause::focal_length, 0.01, 0.0005);
}

TEST(ErrorMonitor, FindsThePrincipalPoint) {
  FaultyRoom setup;
  setup.true_camera.K(0, 2) += 8;
  expectOnly(Driven(setup, 300), ErrorCause::centre, 8, 0.3);
}

TEST(ErrorMonitor, FindsTheDistortion) {
  FaultyRoom setup;
  setup.true_camera.D[0] = -0.1;
  expectOnly(Driven(setup, 300), ErrorCause::distortion, -0.1, 0.002);
}

TEST(ErrorMonitor, FindsTheRollingShutter) {
  FaultyRoom setup;
  setup.readout_time = 0.02;
  expectOnly(Driven(setup, 300), ErrorCause::shutter, 0.02, 0.0005);
}

TEST(ErrorMonitor, FindsTheSizeOfTheMarkers) {
  FaultyRoom setup;
  setup.true_size = 0.204;
  expectOnly(Driven(setup, 300), ErrorCause::marker_size, std::log(1.02), 0.0005);
}

TEST(ErrorMonitor, FindsAMovedMarker) {
  FaultyRoom setup;
  setup.move(6, {0.02, 0.03, -0.02});
  const Driven driven(setup, 300);
  EXPECT_TRUE(driven.errors().empty());
  const auto moved = driven.localization.movedMarkers().moved();
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].key.id, 6);
  EXPECT_LT((moved[0].offset - Eigen::Vector3d(0.02, 0.03, -0.02)).norm(), 0.01);
  EXPECT_GE(driven.inside, 0.9 * driven.poses);
}

// The room of four markers with marker `id` elsewhere in the map, seen by a robot that moves a little.
MarkerLocalization afterImages(int images, int id, const Eigen::Vector3d& offset, size_t in_sight) {
  MarkerMap map = room();
  MappedMarker wrong = *map.find({kFamily, id});
  wrong.T_map_marker.translation() += offset;
  map.set(wrong);
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerLocalization localization{LocalizationParams{}};
  for (int i = 0; i < images; ++i) {
    const Pose T_map_base = kTruth * poseFromXyzRpy({0.01 * (i % 20), 0, 0}, {0, 0, 0});
    MarkerView view = look(room(), camera, T_map_base, 0.3, i);
    view.detections.resize(in_sight);
    localization.locate(map, {view}, std::nullopt, 0.1 * i);
  }
  return localization;
}

TEST(ErrorMonitor, NamesTheMarkerThatWasMovedAndByHowMuch) {
  const auto moved = afterImages(60, 1, {0, 0.08, 0}, 4).movedMarkers().moved();
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].key.id, 1);
  EXPECT_LT((moved[0].offset - Eigen::Vector3d(0, -0.08, 0)).norm(), 0.015);
}

// The error is within the gate of every image, but always in the same direction.
TEST(ErrorMonitor, NamesTheMarkerThatNoImageLeavesOut) {
  const auto moved = afterImages(100, 2, {0.06, 0, 0}, 4).movedMarkers().moved();
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].key.id, 2);
}

// Of two markers that contradict each other, either may have been moved.
TEST(ErrorMonitor, AccusesNoneOfTwo) {
  EXPECT_TRUE(afterImages(100, 1, {0, 0.08, 0}, 2).movedMarkers().moved().empty());
}

// All images are the same: they count as few.
TEST(ErrorMonitor, NamesAMovedMarkerAtAStandstill) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  MarkerMap map = room();
  MappedMarker wrong = *map.find({kFamily, 1});
  wrong.T_map_marker.translation().y() += 0.08;
  map.set(wrong);
  MarkerLocalization localization{LocalizationParams{}};
  for (int i = 0; i < 30; ++i) {
    MarkerView view = look(room(), camera, kTruth, 0.1, i);
    view.detections.resize(3);
    localization.locate(map, {view}, std::nullopt, 0.1 * i);
  }
  const auto moved = localization.movedMarkers().moved();
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].key.id, 1);
}

TEST(ErrorMonitor, IsSilentAtAStandstill) {
  const auto localization = afterImages(200, 1, {0, 0, 0}, 4);
  EXPECT_TRUE(localization.movedMarkers().moved().empty());
  EXPECT_TRUE(localization.errors().errors().empty());
}

TEST(ErrorMonitor, FindsThatTheMapIsInexact) {
  FaultyRoom setup;
  std::mt19937 random(7);
  std::normal_distribution<double> error(0, 0.005);
  for (int id = 0; id < 12; ++id) setup.move(id, {error(random), error(random), error(random)});
  const Driven driven(setup, 300);
  const auto errors = driven.errors();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].cause, ErrorCause::map);
  EXPECT_NEAR(errors[0].value[0], 0.005, 0.002);
}

}  // namespace
}  // namespace sextant
