// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/marker_landmarks.hpp"

#include <cmath>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMinSigma = 1e-4;  // metres and radians: minimum standard deviation of a marker's pose

/// Whether the lower edge of a marker is level enough to give its heading; false only for one that is rotated
/// far in its own plane.
bool isLevel(const Matrix3d& R) { return std::abs(R(2, 0)) < M_SQRT1_2; }

/// Direction from which headingOf() is computed.
Vector3d pointer(const Matrix3d& R) { return isLevel(R) ? R.col(0) : R.col(2); }

/// Jacobian of (x, y, heading) by (position, rotation), both in the axes of the plane's frame.
Eigen::Matrix<double, 3, 6> planeJacobian(const Matrix3d& R) {
  const Vector3d d = pointer(R);
  Eigen::Matrix<double, 3, 6> J = Eigen::Matrix<double, 3, 6>::Zero();
  J.topLeftCorner<2, 2>().setIdentity();
  // derivative of atan2(d_y, d_x) for the change rotation x d of d
  J.block<1, 3>(2, 3) = Eigen::RowVector3d(-d.y(), d.x(), 0) / d.head<2>().squaredNorm() * -skew(d);
  return J;
}

}  // namespace

ParamList MarkerLandmarkParams::fields() {
  return {
      {"heading_min_probability", &heading_min_probability, Range::openHigh(0.5, 1), "",
       "printed markers: the heading is used if the probability of the better of the marker's two poses is "
       "at least this"},
      {"corner_sigma", &corner_sigma, Range::openLow(0, 10), "px",
       "printed markers: standard deviation of a corner coordinate if the detection has none"},
      {"tilt_sigma", &tilt_sigma, Range::closed(0, 1), "rad",
       "printed markers: standard deviation of the robot's roll and pitch relative to the floor"},
  };
}

double headingOf(const Matrix3d& R_map_marker) {
  const Vector3d d = pointer(R_map_marker);
  return wrapped(std::atan2(d.y(), d.x()) - (isLevel(R_map_marker) ? M_PI_2 : 0.0));
}

double alternativePoseProbability(double error, double alternative_error, double sigma) {
  const double coordinates = 8;
  return 1 / (1 + std::exp(coordinates * (alternative_error * alternative_error - error * error) /
                           (2 * sigma * sigma)));
}

LabelledObservation markerObservation(const MarkerKey& key, const Pose& T_base_camera,
                                      const Pose& T_camera_marker, const Matrix6d& covariance,
                                      double alternative_probability, const MarkerLandmarkParams& params) {
  const Pose T_base_marker = T_base_camera * T_camera_marker;
  const Eigen::Matrix<double, 3, 6> J = planeJacobian(T_base_marker.linear());
  Matrix6d turned = Matrix6d::Zero();  // from the axes of the camera to those of the base
  turned.topLeftCorner<3, 3>() = turned.bottomRightCorner<3, 3>() = T_base_camera.linear();
  Eigen::Matrix<double, 6, 3> tilt;  // a rotation of the base moves and rotates the marker
  tilt << -skew(T_base_marker.translation()), Matrix3d::Identity();

  const Eigen::Matrix<double, 3, 6> of_camera = J * turned;
  const Eigen::Matrix<double, 3, 2> of_tilt = params.tilt_sigma * (J * tilt).leftCols<2>();
  LabelledObservation seen{
      {key.family, key.id}, {T_base_marker.translation().head<2>(), {}, Matrix3d::Zero()}, false};
  seen.observation.covariance =
      of_camera * covariance * of_camera.transpose() + of_tilt * of_tilt.transpose();
  if (alternative_probability <= 1 - params.heading_min_probability) {
    seen.observation.heading = headingOf(T_base_marker.linear());
    seen.can_initialize = true;
  }
  return seen;
}

MarkerLandmarks landmarksOf(const MarkerMap& map) {
  MarkerLandmarks found;
  for (const auto& [key, marker] : map.markers()) {
    const Pose& T = marker.T_map_marker;
    const Eigen::Matrix<double, 3, 6> J = planeJacobian(T.linear());
    found.landmarks.push_back({T.translation().head<2>(), headingOf(T.linear())});
    found.labels.push_back({key.family, key.id});
    found.covariances.push_back(J * marker.covariance * J.transpose() +
                                kMinSigma * kMinSigma * Matrix3d::Identity());
  }
  return found;
}

}  // namespace sextant
