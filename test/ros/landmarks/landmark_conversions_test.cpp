// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/landmarks/landmark_conversions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sextant/ros/landmarks/landmark_visualization.hpp"
#include "sextant/ros/markers/marker_conversions.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

constexpr double kNotFinite = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

Matrix3d planeCovariance() {
  Matrix3d covariance;
  covariance << 0.04, 0.01, 0.002, 0.01, 0.09, 0.003, 0.002, 0.003, 0.16;
  return covariance;
}

LandmarkObservations someObservations() {
  LandmarkObservation pillar;
  pillar.class_name = "blue_pillar";
  pillar.id = -1;
  pillar.x = 2;
  pillar.y = 1;
  pillar.heading = kNotFinite;
  pillar.covariance = {0.04, 0.01, kNotFinite, 0.01, 0.09, kNotFinite, kNotFinite, kNotFinite, kNotFinite};
  LandmarkObservation marker = pillar;
  marker.class_name = "tag36h11";
  marker.id = 7;
  marker.heading = 3.0;
  const Matrix3d covariance = planeCovariance();
  std::copy(covariance.data(), covariance.data() + 9, marker.covariance.begin());
  LandmarkObservations msg;
  msg.header.frame_id = "base_link";
  msg.observations = {pillar, marker};
  return msg;
}

std::string reasonAgainst(const LandmarkObservations& msg, const Pose& T_base_frame = Pose::Identity()) {
  try {
    fromMsg(msg, T_base_frame);
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(LandmarkConversions, PlanarPosesRoundTrip) {
  for (const double heading : {-3.1, -1.0, 0.0, 0.5, 3.14}) {
    const auto msg = toPoseWithCovarianceMsg(Pose2{{1.5, -2}, heading}, planeCovariance());
    EXPECT_EQ(msg.pose.position.z, 0);
    EXPECT_EQ(msg.covariance[5], 0.002);  // x and yaw
    EXPECT_EQ(msg.covariance[35], 0.16);  // yaw
    EXPECT_EQ(msg.covariance[14], 0);     // z
    const PoseEstimate2D back = planarFromMsg(msg);
    EXPECT_EQ(back.pose.position, Vector2d(1.5, -2));
    EXPECT_NEAR(back.pose.heading, heading, 1e-12);
    EXPECT_EQ(back.covariance, planeCovariance());
  }
}

TEST(LandmarkConversions, ATiltedPoseIsProjected) {
  const Pose2 pose = planarFromMsg(toPoseMsg(poseFromXyzRpy({1, 2, 3}, {0.1, -0.2, 0.7})));
  EXPECT_EQ(pose.position, Vector2d(1, 2));
  EXPECT_NEAR(pose.heading, 0.7, 1e-12);  // where its x axis points
}

TEST(LandmarkConversions, InvalidCovariancesAreRefused) {
  auto msg = toPoseWithCovarianceMsg(Pose2{}, planeCovariance());
  for (const double value : {0.0, -0.04, kNotFinite, kInfinite}) {
    msg.covariance[0] = value;
    EXPECT_THROW(planarFromMsg(msg), std::invalid_argument) << value;
  }
}

TEST(LandmarkConversions, ObservationsInTheRobotFrameAreNotChanged) {
  const auto seen = fromMsg(someObservations(), Pose::Identity());
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].label, (LandmarkLabel{"blue_pillar", {}}));
  EXPECT_EQ(seen[0].observation.position, Vector2d(2, 1));
  EXPECT_FALSE(seen[0].observation.heading);
  Matrix3d flat = Matrix3d::Zero();
  flat.topLeftCorner<2, 2>() << 0.04, 0.01, 0.01, 0.09;
  EXPECT_EQ(seen[0].observation.covariance, flat);
  EXPECT_EQ(seen[1].label, (LandmarkLabel{"tag36h11", 7}));
  EXPECT_EQ(seen[1].observation.heading, 3.0);
  EXPECT_EQ(seen[1].observation.covariance, planeCovariance());
}

TEST(LandmarkConversions, ASensorThatPointsLeft) {
  const auto seen = fromMsg(someObservations(), poseFromXyzRpy({0.5, 0.25, 1}, {0, 0, M_PI_2}));
  EXPECT_LT((seen[1].observation.position - Vector2d(0.5 - 1, 0.25 + 2)).norm(), 1e-12);
  EXPECT_NEAR(*seen[1].observation.heading, 3.0 + M_PI_2 - 2 * M_PI, 1e-12);
  Matrix3d turned;  // x' = -y, y' = x
  turned << 0.09, -0.01, -0.003, -0.01, 0.04, 0.002, -0.003, 0.002, 0.16;
  EXPECT_TRUE(seen[1].observation.covariance.isApprox(turned, 1e-12));
}

TEST(LandmarkConversions, InvalidObservationsAreRefusedByName) {
  LandmarkObservations msg = someObservations();
  msg.observations[0].x = kNotFinite;
  EXPECT_EQ(reasonAgainst(msg), "the observation of 'blue_pillar' has a number that is not finite");
  msg = someObservations();
  msg.observations[1].heading = kInfinite;
  EXPECT_EQ(reasonAgainst(msg), "the observation of 'tag36h11 7' has a number that is not finite");
  for (const double variance : {0.0, -0.04, kNotFinite}) {
    msg = someObservations();
    msg.observations[0].covariance[0] = variance;
    EXPECT_EQ(reasonAgainst(msg),
              "the observation of 'blue_pillar' has a covariance that is not positive definite");
  }
  msg = someObservations();
  msg.observations[0].covariance[4] = 1e300;
  EXPECT_EQ(reasonAgainst(msg),
            "the observation of 'blue_pillar' has a standard deviation of more than 10 km");
  msg = someObservations();
  msg.observations[0].y = -1e5;
  EXPECT_EQ(reasonAgainst(msg), "the observation of 'blue_pillar' is farther away than 10 km");
  msg = someObservations();
  msg.observations[1].covariance[8] = 0;  // of a heading
  EXPECT_NE(reasonAgainst(msg), "");
  msg = someObservations();
  msg.observations[1].covariance[1] = 0.03;  // not symmetric
  EXPECT_NE(reasonAgainst(msg), "");
  msg = someObservations();
  msg.observations[0].class_name = "";
  EXPECT_EQ(reasonAgainst(msg), "the observation of '' has no class_name");
}

TEST(LandmarkConversions, AnOpticalFrameIsRefused) {
  EXPECT_EQ(reasonAgainst(someObservations(), poseFromXyzRpy({0, 0, 1}, {0, 0.02, 1})), "");
  EXPECT_NE(reasonAgainst(someObservations(), poseFromXyzRpy({0, 0, 1}, {-M_PI_2, 0, -M_PI_2})), "");
}

// A marker 2 m before a camera that looks along the robot's x axis from 0.1 m ahead, and faces it.
MarkerArray someMarkers() {
  Marker marker;
  marker.family = "tag36h11";
  marker.id = 3;
  marker.size = 0.2;
  const Pose facing = poseFromXyzRpy({0.5, 0, 2}, {M_PI, 0, 0});
  marker.pose = toPoseWithCovarianceMsg(facing, 1e-4 * Matrix6d::Identity());
  marker.reprojection_error = 0.1;
  marker.alternative_reprojection_error = -1;
  MarkerArray msg;
  msg.markers = {marker};
  return msg;
}

const Pose T_base_camera = poseFromXyzRpy({0.1, 0, 1}, {-M_PI_2, 0, -M_PI_2});

TEST(LandmarkConversions, AMarkerIsProjectedAndFacesTheCamera) {
  const auto seen = fromMsg(someMarkers(), T_base_camera, {});
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].label, (LandmarkLabel{"tag36h11", 3}));
  EXPECT_LT((seen[0].observation.position - Vector2d(2.1, -0.5)).norm(), 1e-9);
  ASSERT_TRUE(seen[0].observation.heading);
  EXPECT_NEAR(std::abs(*seen[0].observation.heading), M_PI, 1e-9);
  EXPECT_TRUE(seen[0].can_initialize);
}

TEST(LandmarkConversions, AnAmbiguousMarkerHasNoHeading) {
  MarkerArray msg = someMarkers();
  for (const auto& [error, certain] : {std::pair(1.0, true), {0.11, false}, {0.0, false}}) {
    msg.markers[0].alternative_reprojection_error = error;
    EXPECT_EQ(fromMsg(msg, T_base_camera, {})[0].observation.heading.has_value(), certain) << error;
  }
}

TEST(LandmarkConversions, AMappedMarkerMeasuresTheSlopeBelowTheRobot) {
  const Pose T_base_marker = T_base_camera * fromMsg(someMarkers().markers[0].pose.pose);
  const Pose T_level_marker = poseFromXyzRpy({0, 0, 0}, {0, 0.1, 0}) * T_base_marker;
  MarkerMap map;
  const Pose T_map_level = poseFromXyzRpy({4, 5, 0}, {0, 0, 1});
  map.add({{"tag36h11", 3}, 0.2, "", T_map_level * T_level_marker, Matrix6d::Zero()});
  MarkerLandmarkParams params;
  params.ramp_sigma = 0.1;
  const auto off = [&](const MarkerMap* with) {
    const auto seen = fromMsg(someMarkers(), T_base_camera, params, with);
    return (seen[0].observation.position - T_level_marker.translation().head<2>()).norm();
  };
  EXPECT_LT(off(&map), 0.003);
  EXPECT_GT(off(nullptr), 0.08);  // 0.1 rad, 1 m above the base
}

TEST(LandmarkConversions, MarkersWithoutASizeAreSkipped) {
  MarkerArray msg = someMarkers();
  msg.markers.push_back(msg.markers[0]);
  msg.markers[0].size = 0;
  msg.markers[0].pose = {};
  EXPECT_EQ(fromMsg(msg, T_base_camera, {}).size(), 1u);
}

TEST(LandmarkConversions, InvalidMarkersAreRefused) {
  MarkerArray msg = someMarkers();
  msg.markers[0].family = "tag99h99";
  EXPECT_THROW(fromMsg(msg, T_base_camera, {}), std::invalid_argument);
  msg = someMarkers();
  msg.markers[0].pose.pose.position.z = kNotFinite;
  EXPECT_THROW(fromMsg(msg, T_base_camera, {}), std::invalid_argument);
  msg = someMarkers();
  msg.markers[0].pose.covariance[0] = kNotFinite;
  EXPECT_THROW(fromMsg(msg, T_base_camera, {}), std::invalid_argument);
}

LandmarkSlam someSlam() {
  LandmarkSlam slam({}, {{1, 2}, 0.5}, 0.01 * Matrix3d::Identity());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(8, 8);
  for (int i = 0; i < 8; ++i) covariance(i, i) = 0.01 * (i + 1);
  slam.setMap({{1, 2}, 0.5}, {{{3, 4}, {}}, {{5, 6}, -1.5}}, {{"red_pillar", {}}, {"tag36h11", 9}},
              covariance);
  return slam;
}

TEST(LandmarkConversions, LandmarksAreConvertedWithTheirCovariances) {
  const LandmarkMapEntries msg = toMsg(someSlam());
  ASSERT_EQ(msg.landmarks.size(), 2u);
  const LandmarkMapEntry &pillar = msg.landmarks[0], &marker = msg.landmarks[1];
  EXPECT_EQ(pillar.class_name, "red_pillar");
  EXPECT_EQ(pillar.id, -1);
  EXPECT_EQ(pillar.x, 3);
  EXPECT_TRUE(std::isnan(pillar.heading));
  EXPECT_NEAR(pillar.covariance[4], 0.05, 1e-12);
  EXPECT_EQ(pillar.covariance[8], 0);
  EXPECT_EQ(marker.id, 9);
  EXPECT_EQ(marker.heading, -1.5);
  EXPECT_NEAR(marker.covariance[8], 0.08, 1e-12);
  EXPECT_NE(pillar.key, marker.key);
}

TEST(LandmarkVisualization, TheColourIsTheOneInTheName) {
  EXPECT_GT(colourOfClass("blue_pillar").b, 2 * colourOfClass("blue_pillar").r);
  EXPECT_GT(colourOfClass("big_red").r, 2 * colourOfClass("big_red").b);
  EXPECT_NE(colourOfClass("chair"), colourOfClass("tag36h11"));
  EXPECT_EQ(colourOfClass("chair"), colourOfClass("chair"));
}

TEST(LandmarkVisualization, TheEllipseIsTwoSigmaAndRemovedLandmarksAreDeleted) {
  using visualization_msgs::Marker;
  LandmarkVisualization visualization;
  const auto shown = visualization.update(someSlam(), "hall", ros::Time(5)).markers;
  const auto ellipse =
      std::find_if(shown.begin(), shown.end(), [](const Marker& each) { return each.ns == "2 sigma"; });
  ASSERT_NE(ellipse, shown.end());
  EXPECT_EQ(ellipse->header.frame_id, "hall");
  EXPECT_NEAR(ellipse->scale.x, 4 * std::sqrt(0.04), 1e-9);  // from side to side, of the smaller variance
  EXPECT_NEAR(ellipse->scale.y, 4 * std::sqrt(0.05), 1e-9);
  EXPECT_NEAR(ellipse->pose.orientation.w * ellipse->pose.orientation.z, 0, 1e-9);  // along x
  const auto count = [](const std::vector<Marker>& all, int type, int action) {
    return std::count_if(all.begin(), all.end(),
                         [&](const Marker& each) { return each.type == type && each.action == action; });
  };
  EXPECT_EQ(count(shown, Marker::ARROW, Marker::ADD), 1);  // one of them has a heading
  const LandmarkSlam empty({}, {}, Matrix3d::Identity());
  const auto gone = visualization.update(empty, "hall", ros::Time(6)).markers;
  EXPECT_EQ(gone.size(), 8u);
  for (const Marker& each : gone) EXPECT_EQ(each.action, Marker::DELETE);
  EXPECT_TRUE(visualization.update(empty, "hall", ros::Time(7)).markers.empty());
}

/// At (2, 1), turned by a quarter.
PlaceHypotheses somePlaces(double heading_variance = 0.1) {
  PlaceHypothesis place;
  place.id = 4;
  place.probability = 0.8F;
  place.pose =
      toPoseWithCovarianceMsg({{2, 1}, M_PI_2}, Eigen::Vector3d(0.3, 0.2, heading_variance).asDiagonal());
  PlaceHypotheses msg;
  msg.places = {place};
  return msg;
}

TEST(LandmarkConversions, PlacesArePosesInTheMap) {
  const auto poses = fromMsg(somePlaces(), Pose2{{10, 0}, M_PI_2});
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_LT(difference(poses[0].T_map_base, {{9, 2}, M_PI}).norm(), 1e-9);
  EXPECT_LT((poses[0].covariance - Matrix3d(Eigen::Vector3d(0.2, 0.3, 0.1).asDiagonal())).norm(), 1e-9);
  EXPECT_NEAR(poses[0].probability, 0.8, 1e-6);
}

TEST(LandmarkConversions, APlaceWithoutAHeadingHasPosesInAllDirections) {
  const auto poses = fromMsg(somePlaces(M_PI * M_PI / 3), Pose2{});
  double sum = 0, squares = 0;
  for (const PossiblePose& each : poses) {
    const double off = wrapped(each.T_map_base.heading);
    sum += each.probability;
    squares += each.probability / 0.8 * (each.covariance(2, 2) + off * off);
    EXPECT_EQ(each.T_map_base.position, Vector2d(2, 1));
  }
  EXPECT_NEAR(sum, 0.8, 1e-6);
  EXPECT_NEAR(squares, M_PI * M_PI / 3, 0.7);  // that of a uniform angle, which also has -pi beside pi
}

TEST(LandmarkConversions, PlacesOfAnImageThatIsNotUsableAreNotUsed) {
  PlaceHypotheses msg = somePlaces();
  msg.status = PlaceHypotheses::UNUSABLE;
  EXPECT_TRUE(fromMsg(msg, Pose2{}).empty());
}

TEST(LandmarkConversions, RefusesPlacesThatCannotBe) {
  for (const float probability : {0.0F, -0.5F, 1.5F, std::numeric_limits<float>::quiet_NaN()}) {
    PlaceHypotheses msg = somePlaces();
    msg.places[0].probability = probability;
    EXPECT_THROW(fromMsg(msg, Pose2{}), std::invalid_argument);
  }
  PlaceHypotheses msg = somePlaces();
  msg.places[0].pose.pose.position.x = kNotFinite;
  EXPECT_THROW(fromMsg(msg, Pose2{}), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
