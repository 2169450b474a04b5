// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/landmarks/landmark_conversions.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "sextant/markers/marker_family.hpp"
#include "sextant/ros/markers/marker_conversions.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr int kPlanar[] = {0, 1, 5};   // indices of x, y, heading in x, y, z, roll, pitch, yaw
constexpr double kMinCosTilt = 0.999;  // of a frame whose z axis is up
constexpr double kMaxDistance = 1e8;   // metres: larger values lose too much numeric resolution

constexpr int kHeadings = 4;               // poses of a place at which the heading is not known
constexpr double kMaxHeadingVariance = 1;  // square radians: if it is larger, the heading is not known

constexpr double kMaxObserved = 1e4;  // metres to a landmark, and of a standard deviation: as kMaxDistance

bool isPositiveDefinite(const Eigen::MatrixXd& matrix) {
  return matrix.allFinite() && matrix.isApprox(matrix.transpose(), 1e-6) &&
         matrix.llt().info() == Eigen::Success;
}

std::string nameOf(const LandmarkLabel& label) {
  return label.class_name + (label.id ? " " + std::to_string(*label.id) : "");
}

void requireObservation(const LabelledObservation& seen) {
  const Observation2D& observation = seen.observation;
  const auto refuse = [&](const std::string& reason) {
    throw std::invalid_argument("the observation of '" + nameOf(seen.label) + "' " + reason);
  };
  if (seen.label.class_name.empty()) refuse("has no class_name");
  if (!observation.position.allFinite() || std::isinf(observation.heading.value_or(0)))
    refuse("has a number that is not finite");
  const int width = observation.heading ? 3 : 2;
  if (!isPositiveDefinite(observation.covariance.topLeftCorner(width, width)))
    refuse("has a covariance that is not positive definite");
  if (observation.position.norm() > kMaxObserved) refuse("is farther away than 10 km");
  if (observation.covariance.topLeftCorner(width, width).trace() > kMaxObserved * kMaxObserved)
    refuse("has a standard deviation of more than 10 km");
}

LabelledObservation fromMsg(const LandmarkObservation& msg, const Pose& T_base_frame) {
  const Matrix3d& R = T_base_frame.linear();
  LabelledObservation seen{{msg.class_name, {}}, {{msg.x, msg.y}, {}, Matrix3d::Zero()}};
  if (msg.id >= 0) seen.label.id = msg.id;
  if (!std::isnan(msg.heading)) seen.observation.heading = msg.heading;
  const int width = seen.observation.heading ? 3 : 2;
  seen.observation.covariance.topLeftCorner(width, width) =
      Eigen::Map<const RowMajor3>(msg.covariance.data()).topLeftCorner(width, width);
  requireObservation(seen);
  const Pose2 T{T_base_frame.translation().head<2>(), std::atan2(R(1, 0), R(0, 0))};
  seen.observation.position = T * seen.observation.position;
  if (seen.observation.heading) seen.observation.heading = wrapped(*seen.observation.heading + T.heading);
  Matrix3d turn = Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = rotation2(T.heading);
  seen.observation.covariance = (turn * seen.observation.covariance * turn.transpose()).eval();
  return seen;
}

/// Probability that the alternative pose of a marker is the true one.
double alternativeProbabilityOf(const Marker& msg, double corner_sigma) {
  if (msg.alternative_reprojection_error < 0) return 0;
  double squares = 0;
  for (const double sigma : msg.corner_sigmas)
    squares += std::pow(sigma > 0 ? sigma : corner_sigma, 2) / static_cast<double>(msg.corner_sigmas.size());
  return alternativePoseProbability(msg.reprojection_error, msg.alternative_reprojection_error,
                                    std::sqrt(squares));
}

}  // namespace

Pose toPose(const Pose2& pose) {
  return poseFromXyzRpy({pose.position.x(), pose.position.y(), 0}, {0, 0, pose.heading});
}

Pose2 planarSensorPose(const Pose& T_base_frame) {
  const Eigen::Vector3d x = T_base_frame.linear().col(0), z = T_base_frame.linear().col(2);
  const Eigen::Vector3d ahead = std::abs(z.z()) < M_SQRT1_2 ? z : x;
  return {T_base_frame.translation().head<2>(), std::atan2(ahead.y(), ahead.x())};
}

geometry_msgs::PoseWithCovariance toPoseWithCovarianceMsg(const Pose2& pose, const Matrix3d& covariance) {
  geometry_msgs::PoseWithCovariance msg;
  msg.pose = toPoseMsg(toPose(pose));
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) msg.covariance[6 * kPlanar[i] + kPlanar[k]] = covariance(i, k);
  return msg;
}

Pose2 planarFromMsg(const geometry_msgs::Pose& msg) {
  const Pose pose = fromMsg(msg);
  if (pose.translation().head<2>().norm() > kMaxDistance)
    throw std::invalid_argument("the position is farther from the origin than 1e8 m");
  return {pose.translation().head<2>(), std::atan2(pose(1, 0), pose(0, 0))};
}

PoseEstimate2D planarFromMsg(const geometry_msgs::PoseWithCovariance& msg) {
  const Matrix6d spatial = fromMsg(msg.covariance);
  PoseEstimate2D estimate{planarFromMsg(msg.pose), {}};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) estimate.covariance(i, k) = spatial(kPlanar[i], kPlanar[k]);
  if (!isPositiveDefinite(estimate.covariance))
    throw std::invalid_argument("the covariance of x, y and heading is not positive definite");
  return estimate;
}

std::vector<LabelledObservation> fromMsg(const LandmarkObservations& msg, const Pose& T_base_frame) {
  if (T_base_frame(2, 2) < kMinCosTilt)
    throw std::invalid_argument(
        "the z axis of frame '" + msg.header.frame_id +
        "' is not up: publish observations in base_link or a frame that is level with it");
  std::vector<LabelledObservation> all;
  for (const LandmarkObservation& observation : msg.observations)
    all.push_back(fromMsg(observation, T_base_frame));
  return all;
}

std::vector<LabelledObservation> fromMsg(const MarkerArray& msg, const Pose& T_base_camera,
                                         const MarkerLandmarkParams& params, const MarkerMap* map) {
  std::vector<SeenMarker> seen;
  for (const Marker& marker : msg.markers)
    if (marker.size > 0)
      seen.push_back({{canonicalFamily(marker.family), marker.id},
                      fromMsg(marker.pose.pose),
                      fromMsg(marker.pose.covariance),
                      alternativeProbabilityOf(marker, params.corner_sigma)});
  const auto all = markerObservations(seen, T_base_camera, params, map);
  std::for_each(all.begin(), all.end(), requireObservation);
  return all;
}

std::vector<PossiblePose> fromMsg(const PlaceHypotheses& msg, const Pose2& T_map_frame) {
  std::vector<PossiblePose> poses;
  if (msg.status == PlaceHypotheses::UNUSABLE) return poses;
  Matrix3d turn = Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = rotation2(T_map_frame.heading);
  for (const PlaceHypothesis& place : msg.places) {
    if (!(place.probability > 0 && place.probability <= 1.001))
      throw std::invalid_argument("the probability of place " + std::to_string(place.id) + " is " +
                                  std::to_string(place.probability));
    const PoseEstimate2D at = planarFromMsg(place.pose);
    Matrix3d covariance = turn * at.covariance * turn.transpose();
    const int headings = covariance(2, 2) > kMaxHeadingVariance ? kHeadings : 1;
    if (headings > 1) {  // uniform between the headings
      covariance.row(2).setZero(), covariance.col(2).setZero();
      covariance(2, 2) = std::pow(2 * M_PI / headings, 2) / 12;
    }
    Pose2 pose = T_map_frame * at.pose;
    for (int i = 0; i < headings; ++i, pose.heading = wrapped(pose.heading + 2 * M_PI / headings))
      poses.push_back({pose, covariance, place.probability / headings});
  }
  return poses;
}

LandmarkMapEntries toMsg(const LandmarkSlam& slam) {
  LandmarkMapEntries msg;
  for (size_t i = 0; i < slam.labels().size(); ++i) {
    const Landmark2D& landmark = slam.filter().landmarks()[i];
    const int width = landmark.dimension();
    LandmarkMapEntry entry;
    entry.key = slam.keys()[i];
    entry.class_name = slam.labels()[i].class_name;
    entry.id = slam.labels()[i].id.value_or(-1);
    entry.x = landmark.position.x();
    entry.y = landmark.position.y();
    entry.heading = landmark.heading.value_or(std::numeric_limits<double>::quiet_NaN());
    Eigen::Map<RowMajor3>(entry.covariance.data()).topLeftCorner(width, width) =
        slam.filter().covariance({i}).block(3, 3, width, width);
    msg.landmarks.push_back(entry);
  }
  return msg;
}

}  // namespace sextant
