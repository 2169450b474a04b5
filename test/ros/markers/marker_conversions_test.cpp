// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/markers/marker_conversions.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "test_poses.hpp"

namespace sextant {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

Detection someDetection() {
  Detection detection;
  detection.key = {"tag36h11", 7};
  detection.corners = {Eigen::Vector2d(1, 2), {3, 4}, {5, 6}, {7, 8}};
  detection.corner_sigmas = {0.03, 0.05, 2.5, -1};
  detection.hamming = 1;
  detection.decision_margin = 55.5;
  return detection;
}

TEST(MarkerConversions, DetectionsComeBack) {
  const Detection detection = someDetection();
  const Marker msg = toMsg(detection, 0.2, std::nullopt, std::nullopt);
  EXPECT_EQ(msg.size, 0);  // there is no pose that it would belong to
  EXPECT_EQ(msg.alternative_reprojection_error, -1);
  const Detection back = fromMsg(msg);
  EXPECT_EQ(back.key, detection.key);
  EXPECT_EQ(back.corners, detection.corners);
  EXPECT_EQ(back.corner_sigmas, detection.corner_sigmas);
  EXPECT_EQ(back.hamming, 1);
  EXPECT_EQ(back.decision_margin, 55.5);
}

TEST(MarkerConversions, WhatIsNoDeviationIsUnknown) {
  Marker msg = toMsg(someDetection(), 0.2, std::nullopt, std::nullopt);
  msg.corner_sigmas = {0, -3, kNotANumber, 0.2};
  EXPECT_EQ(fromMsg(msg).corner_sigmas, (CornerSigmas{-1, -1, -1, 0.2}));
}

TEST(MarkerConversions, BothPosesAreTold) {
  const Pose best = poseFromXyzRpy({0, 0, 2}, {3, 0, 0}), other = poseFromXyzRpy({0, 0, 2}, {-3, 0, 0});
  const PlanarPoses poses{{best, 0.1}, MarkerPose{other, 0.4}};
  const Marker msg = toMsg(someDetection(), 0.2, poses, someCovariance());
  EXPECT_EQ(msg.size, 0.2);
  EXPECT_TRUE(fromMsg(msg.pose.pose).isApprox(best, 1e-12));
  EXPECT_EQ(fromMsg(msg.pose.covariance), someCovariance());
  EXPECT_EQ(msg.reprojection_error, 0.1);
  EXPECT_TRUE(fromMsg(msg.alternative_pose).isApprox(other, 1e-12));
  EXPECT_EQ(msg.alternative_reprojection_error, 0.4);
}

TEST(MarkerConversions, AFamilyHasOneNameAndCornersAreFinite) {
  Marker msg = toMsg(someDetection(), 0.2, std::nullopt, std::nullopt);
  msg.family = "DICT_APRILTAG_36h11";
  EXPECT_EQ(fromMsg(msg).key.family, "tag36h11");
  msg.corners[5] = kNotANumber;
  EXPECT_THROW(fromMsg(msg), std::invalid_argument);
  msg.corners[5] = 0;
  msg.family = "tag99h99";
  EXPECT_THROW(fromMsg(msg), std::invalid_argument);
}

TEST(MarkerConversions, MapsComeBack) {
  std::mt19937 random(2);
  const MappedMarker a{{"tag36h11", 3}, 0.2, "door", randomPose(random), someCovariance()};
  const MappedMarker b{{"DICT_4X4_50", 3}, 0.5, "", randomPose(random), Matrix6d::Zero()};
  MarkerMapEntries msg;
  msg.header.frame_id = "hall";
  msg.markers = {toMsg(a), toMsg(b)};
  const MarkerMap map = fromMsg(msg);
  EXPECT_EQ(map.frame(), "hall");
  ASSERT_EQ(map.markers().size(), 2u);
  const MappedMarker& back = *map.find(a.key);
  EXPECT_EQ(back.size, 0.2);
  EXPECT_EQ(back.name, "door");
  EXPECT_TRUE(back.T_map_marker.isApprox(a.T_map_marker, 1e-12));
  EXPECT_EQ(back.covariance, a.covariance);
  EXPECT_EQ(map.find(b.key)->name, "DICT_4X4_50/3");
}

TEST(MarkerConversions, MapsThatCannotBeAreRefused) {
  MarkerMapEntries msg;
  const MarkerMapEntry entry =
      toMsg(MappedMarker{{"tag36h11", 3}, 0.2, "", Pose::Identity(), Matrix6d::Zero()});
  msg.markers = {entry};
  EXPECT_THROW(fromMsg(msg), std::invalid_argument);  // no frame
  msg.header.frame_id = "map";
  EXPECT_NO_THROW(fromMsg(msg));
  msg.markers = {entry, entry};
  EXPECT_THROW(fromMsg(msg), std::invalid_argument);
  msg.markers.resize(1);
  msg.markers[0].pose.covariance[1] = 1.0;  // not symmetric
  EXPECT_THROW(fromMsg(msg), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
