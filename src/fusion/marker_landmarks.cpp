// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/marker_landmarks.hpp"

#include <cmath>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kExact = 1e-4;  // metres and radians: the least deviation of a marker's pose

/// Prints hang level, and those that lean are level, too: only one that is turned far
/// in its own plane has its edge so steep that the normal has to do.
bool isLevel(const Matrix3d& R) { return std::abs(R(2, 0)) < M_SQRT1_2; }

/// What headingOf() looks at.
Vector3d pointer(const Matrix3d& R) { return isLevel(R) ? R.col(0) : R.col(2); }

/// (x, y, heading) by (position, rotation), both in the axes of the plane's frame.
Eigen::Matrix<double, 3, 6> planeJacobian(const Matrix3d& R) {
  const Vector3d d = pointer(R);
  Eigen::Matrix<double, 3, 6> J = Eigen::Matrix<double, 3, 6>::Zero();
  J.topLeftCorner<2, 2>().setIdentity();
  // of atan2(d_y, d_x), d moved by rotation x d
  J.block<1, 3>(2, 3) = Eigen::RowVector3d(-d.y(), d.x(), 0) / d.head<2>().squaredNorm() * -skew(d);
  return J;
}

}  // namespace

ParamList MarkerLandmarkParams::fields() {
  return {
      {"decided", &decided, Range::openHigh(0.5, 1), "",
       "printed markers: probability of a marker's pose from which its heading is used"},
      {"corner_sigma", &corner_sigma, Range::openLow(0, 10), "px",
       "printed markers: noise of a corner's coordinate where the detection has none"},
      {"tilt_sigma", &tilt_sigma, Range::closed(0, 1), "rad",
       "printed markers: deviation of the robot's roll and pitch from those of the floor"},
  };
}

double headingOf(const Matrix3d& R_map_marker) {
  const Vector3d d = pointer(R_map_marker);
  return wrapped(std::atan2(d.y(), d.x()) - (isLevel(R_map_marker) ? M_PI_2 : 0.0));
}

double probabilityOfOther(double error, double other_error, double sigma) {
  const double coordinates = 8;
  return 1 / (1 + std::exp(coordinates * (other_error * other_error - error * error) / (2 * sigma * sigma)));
}

LabelledSighting markerSighting(const MarkerKey& key, const Pose& T_base_camera, const Pose& T_camera_marker,
                                const Matrix6d& covariance, double other,
                                const MarkerLandmarkParams& params) {
  const Pose T_base_marker = T_base_camera * T_camera_marker;
  const Eigen::Matrix<double, 3, 6> J = planeJacobian(T_base_marker.linear());
  Matrix6d turned = Matrix6d::Zero();  // from the camera's axes to the base's
  turned.topLeftCorner<3, 3>() = turned.bottomRightCorner<3, 3>() = T_base_camera.linear();
  Eigen::Matrix<double, 6, 3> tilt;  // the base's rotation moves and turns what is seen
  tilt << -skew(T_base_marker.translation()), Matrix3d::Identity();

  const Eigen::Matrix<double, 3, 6> of_camera = J * turned;
  const Eigen::Matrix<double, 3, 2> of_tilt = params.tilt_sigma * (J * tilt).leftCols<2>();
  LabelledSighting seen{
      {key.family, key.id}, {T_base_marker.translation().head<2>(), {}, Matrix3d::Zero()}, false};
  seen.sighting.covariance = of_camera * covariance * of_camera.transpose() + of_tilt * of_tilt.transpose();
  if (other <= 1 - params.decided) {
    seen.sighting.heading = headingOf(T_base_marker.linear());
    seen.begins = true;
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
                                kExact * kExact * Matrix3d::Identity());
  }
  return found;
}

}  // namespace sextant
