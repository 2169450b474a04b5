// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/moved_marker_detector.hpp"

#include <gtest/gtest.h>

#include "test_cameras.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

// A room whose marker 1 hangs 8 cm from its position in the map.
MarkerMap taped() {
  MarkerMap map;
  const MarkerMap exact = room();
  for (auto [key, marker] : exact.markers()) {
    if (key.id == 1) marker.T_map_marker.translation().y() += 0.08;
    map.add(marker);
  }
  return map;
}

MovedMarkerDetector after(int images, const MarkerMap& map) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const MarkerLocator locator{LocatorParams{}};
  MovedMarkerDetector watch;
  for (int i = 0; i < images; ++i) {
    const Pose T_map_base = kTruth * poseFromXyzRpy({0.01 * (i % 20), 0, 0}, {0, 0, 0});
    const auto result = locator.locate(map, {look(room(), camera, T_map_base, 0.3, i)});
    if (result.pose) watch.add(*result.pose, map);
  }
  return watch;
}

TEST(MovedMarkerDetector, NamesTheMarkerThatWasMovedAndByHowMuch) {
  const auto moved = after(40, taped()).moved();
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].key.id, 1);
  EXPECT_LT((moved[0].offset - Eigen::Vector3d(0, -0.08, 0)).norm(), 0.01);
  EXPECT_EQ(moved[0].images, 40);
}

// The error is within the gate of every image, but always in the same direction.
TEST(MovedMarkerDetector, NamesTheMarkerThatNoImageLeavesOut) {
  MarkerMap map;
  const MarkerMap exact = room();
  for (auto [key, marker] : exact.markers()) {
    if (key.id == 2) marker.T_map_marker.translation().x() += 0.06;
    map.add(marker);
  }
  const auto moved = after(60, map).moved();
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].key.id, 2);
  EXPECT_LT((moved[0].offset - Eigen::Vector3d(-0.06, 0, 0)).norm(), 0.015);
}

// Of two markers that contradict each other, either may have been moved.
TEST(MovedMarkerDetector, AccusesNoneOfTwo) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const MarkerLocator locator{LocatorParams{}};
  MovedMarkerDetector watch;
  for (int i = 0; i < 60; ++i) {
    MarkerView view = look(room(), camera, kTruth, 0.3, i);
    view.detections.resize(2);
    const auto result = locator.locate(taped(), {view});
    if (result.pose) watch.add(*result.pose, taped());
  }
  EXPECT_TRUE(watch.moved().empty());
}

TEST(MovedMarkerDetector, IsNotHastyAndAccusesNobodyFalsely) {
  EXPECT_TRUE(after(5, taped()).moved().empty());
  EXPECT_TRUE(after(100, room()).moved().empty());
}

// The limited mean square of 60 needs 63 images to fall to 12: 8 + 52 * 0.96^n.
TEST(MovedMarkerDetector, ForgetsAMarkerThatWasPutBack) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const MarkerLocator locator{LocatorParams{}};
  MovedMarkerDetector watch = after(40, taped());
  for (int i = 0; i < 80; ++i)
    watch.add(*locator.locate(room(), {look(room(), camera, kTruth, 0.3, i)}).pose, room());
  EXPECT_TRUE(watch.moved().empty());
}

}  // namespace
}  // namespace sextant
