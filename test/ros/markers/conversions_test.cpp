// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/markers/conversions.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace sextant {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Pose randomPose(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-3.1, 3.1);
  const auto draw = [&] { return uniform(random); };
  return poseFromXyzRpy({draw(), draw(), draw()}, {draw(), draw() / 2, draw()});
}

Matrix6d someCovariance() {
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root.data()[i] = 0.01 * (i % 7) + (i % 7 == 0 ? 0.1 : 0.0);
  return root * root.transpose();
}

Detection someDetection() {
  Detection detection;
  detection.key = {"tag36h11", 7};
  detection.corners = {Eigen::Vector2d(1, 2), {3, 4}, {5, 6}, {7, 8}};
  detection.corner_sigmas = {0.03, 0.05, 2.5, -1};
  detection.hamming = 1;
  detection.decision_margin = 55.5;
  return detection;
}

sensor_msgs::CameraInfo someCameraInfo() {
  sensor_msgs::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.D = {0.1, -0.2, 0.003, 0.004, 0.05};
  info.K = {600, 2, 319.5, 0, 610, 239.5, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {500, 0, 315.5, -50, 0, 500, 235.5, 0, 0, 0, 1, 0};
  return info;
}

TEST(Conversions, PosesComeBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Pose pose = randomPose(random);
    EXPECT_TRUE(fromMsg(toPoseMsg(pose)).isApprox(pose, 1e-12));
    EXPECT_TRUE(fromMsg(toTransformMsg(pose)).isApprox(pose, 1e-12));
  }
}

TEST(Conversions, AQuarterTurnAboutZ) {
  const auto msg = toPoseMsg(poseFromXyzRpy({1, 2, 3}, {0, 0, M_PI_2}));
  EXPECT_EQ(msg.position.y, 2);
  EXPECT_NEAR(msg.orientation.z, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(msg.orientation.w, std::sqrt(0.5), 1e-12);
}

TEST(Conversions, WhatIsNoPoseIsRefused) {
  EXPECT_THROW(fromMsg(geometry_msgs::Pose()), std::invalid_argument);  // quaternion 0 0 0 0
  geometry_msgs::Pose pose = toPoseMsg(Pose::Identity());
  pose.orientation.w = 1.02;
  EXPECT_THROW(fromMsg(pose), std::invalid_argument);
  pose.orientation.w = kNaN;
  EXPECT_THROW(fromMsg(pose), std::invalid_argument);
  pose = toPoseMsg(Pose::Identity());
  pose.position.z = std::numeric_limits<double>::infinity();
  EXPECT_THROW(fromMsg(pose), std::invalid_argument);
}

TEST(Conversions, CovarianceKeepsTheOrderOfPoseWithCovariance) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance(0, 5) = covariance(5, 0) = 7;  // x with rotation about Z
  const auto msg = toPoseWithCovarianceMsg(Pose::Identity(), covariance);
  EXPECT_EQ(msg.covariance[5], 7);
  EXPECT_EQ(msg.covariance[30], 7);
  EXPECT_EQ(fromMsg(msg.covariance), covariance);
}

TEST(Conversions, DetectionsComeBack) {
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

TEST(Conversions, WhatIsNoDeviationIsUnknown) {
  Marker msg = toMsg(someDetection(), 0.2, std::nullopt, std::nullopt);
  msg.corner_sigmas = {0, -3, kNaN, 0.2};
  EXPECT_EQ(fromMsg(msg).corner_sigmas, (CornerSigmas{-1, -1, -1, 0.2}));
}

TEST(Conversions, BothPosesAreTold) {
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

TEST(Conversions, AFamilyHasOneNameAndCornersAreFinite) {
  Marker msg = toMsg(someDetection(), 0.2, std::nullopt, std::nullopt);
  msg.family = "DICT_APRILTAG_36h11";
  EXPECT_EQ(fromMsg(msg).key.family, "tag36h11");
  msg.corners[5] = kNaN;
  EXPECT_THROW(fromMsg(msg), std::invalid_argument);
  msg.corners[5] = 0;
  msg.family = "tag99h99";
  EXPECT_THROW(fromMsg(msg), std::invalid_argument);
}

TEST(Conversions, CalibrationIsReadByRows) {
  const CameraCalibration calibration = fromMsg(someCameraInfo());
  EXPECT_EQ(calibration.width, 640);
  EXPECT_EQ(calibration.K(0, 2), 319.5);
  EXPECT_EQ(calibration.K(1, 1), 610);
  EXPECT_EQ(calibration.P(0, 3), -50);
  EXPECT_EQ(calibration.D.size(), 5u);
}

// A region moves the origin; merging 2 x 4 pixels makes one whose centre is theirs.
TEST(Conversions, RegionAndBinningKeepEveryRay) {
  sensor_msgs::CameraInfo info = someCameraInfo();
  const CameraModel whole(fromMsg(info), CameraModel::Image::raw);
  info.roi.x_offset = 40;
  info.roi.y_offset = 80;
  info.roi.width = 400;
  info.roi.height = 320;
  info.binning_x = 2;
  info.binning_y = 4;
  const CameraCalibration part = fromMsg(info);
  EXPECT_EQ(part.width, 200);
  EXPECT_EQ(part.height, 80);
  for (const auto kind : {CameraModel::Image::raw, CameraModel::Image::rectified}) {
    info = someCameraInfo();
    const CameraModel full(fromMsg(info), kind), binned(part, kind);
    const Eigen::Vector3d point(0.2, -0.1, 1.0);
    const Eigen::Vector2d pixel = *full.project(point);
    const Eigen::Vector2d expected((pixel.x() - 40 - 0.5) / 2, (pixel.y() - 80 - 1.5) / 4);
    EXPECT_LT((*binned.project(point) - expected).norm(), 1e-9);
  }
}

TEST(Conversions, CalibrationsThatCannotBeDoNotBecomeCameras) {
  sensor_msgs::CameraInfo info = someCameraInfo();
  info.binning_x = std::numeric_limits<uint32_t>::max();
  EXPECT_THROW(CameraModel(fromMsg(info), CameraModel::Image::raw), std::invalid_argument);
  info = someCameraInfo();
  info.width = std::numeric_limits<uint32_t>::max();
  EXPECT_THROW(CameraModel(fromMsg(info), CameraModel::Image::raw), std::invalid_argument);
}

TEST(Conversions, MapsComeBack) {
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

TEST(Conversions, MapsThatCannotBeAreRefused) {
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
