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

// A detector that has seen some images; and how often it suspected a marker.
struct Watched {
  MovedMarkerDetector detector;
  int suspicions = 0;

  void look(int images, const MarkerMap& map) {
    const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
    const MarkerLocator locator{LocatorParams{}};
    for (int i = 0; i < images; ++i) {
      const Pose T_map_base = kTruth * poseFromXyzRpy({0.01 * (i % 20), 0, 0}, {0, 0, 0});
      const auto result = locator.locate(map, {sextant::look(room(), camera, T_map_base, 0.3, i)});
      if (result.pose) suspicions += detector.add(*result.pose, map);
    }
  }
};

TEST(MovedMarkerDetector, SuspectsAMarkerThatWasMoved) {
  Watched watched;
  watched.look(40, taped());
  EXPECT_GE(watched.suspicions, 2);
  EXPECT_TRUE(watched.detector.moved().empty());  // it may be something else
}

TEST(MovedMarkerDetector, MeasuresHowFarAMarkerIsFromItsPosition) {
  Watched watched;
  watched.detector.exclude({kFamily, 1});
  watched.look(40, taped());
  const auto moved = watched.detector.moved();
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].key.id, 1);
  EXPECT_LT((moved[0].offset - Eigen::Vector3d(0, -0.08, 0)).norm(), 0.01);
  EXPECT_EQ(moved[0].images, 40);
}

TEST(MovedMarkerDetector, IsNotHastyAndSuspectsNobodyFalsely) {
  Watched few, right;
  few.look(5, taped());
  right.look(100, room());
  EXPECT_EQ(few.suspicions + right.suspicions, 0);
}

// The limited mean square of 60 needs 63 images to fall to 12: 8 + 52 * 0.96^n.
TEST(MovedMarkerDetector, ForgetsAMarkerThatWasPutBack) {
  Watched watched;
  watched.look(40, taped());
  watched.detector.exclude({kFamily, 1});
  watched.look(40, taped());
  EXPECT_EQ(watched.detector.keys().size(), 1u);
  watched.look(120, room());
  EXPECT_TRUE(watched.detector.moved().empty());
}

}  // namespace
}  // namespace sextant
