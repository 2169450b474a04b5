// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/marker_landmarks.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <optional>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix62 = Eigen::Matrix<double, 6, 2>;

constexpr double kMinSigma = 1e-4;    // metres and radians: minimum standard deviation of a marker's pose
constexpr double kSameTilt = 0.9999;  // of the squared tilt; a larger one is no ramp, but a wrong marker
constexpr double kUsual = 0.99;       // of the squared error of a marker, above which it has less weight

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

/// Pose of a marker in the base, with the covariance in the axes of the base.
struct Sight {
  Pose T_base_marker;
  Matrix6d covariance;
  const MappedMarker* mapped;  // nullptr: it does not measure the tilt
};

/// Tilt of the robot, as the rotation vector (x, y) of T_level_base.
struct Tilt {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  std::vector<Matrix62> cross;  // covariance of the errors of each sight and of the tilt
};

/// The pose of the base in the map by all mapped markers of an image, by least squares with Huber's weights.
class SlopeFit {
 public:
  /// @param variance of the tilt about x and about y
  SlopeFit(const std::vector<Sight>& sights, double variance) : sights_(sights), variance_(variance) {
    const Sight* best = nullptr;
    for (const Sight& each : sights)
      if (each.mapped && (!best || each.covariance.trace() < best->covariance.trace())) best = &each;
    T_map_base_ = best->mapped->T_map_marker * best->T_base_marker.inverse();
    for (int i = 0; i < kSteps; ++i) T_map_base_ = perturbed(T_map_base_, step());
  }

  /// Nothing if no ramp is so steep.
  std::optional<Tilt> tilt() const {
    const Matrix3d R_level_base = uprightOf(T_map_base_.linear().transpose().col(2), Vector3d::UnitZ());
    const Eigen::Matrix2d R_map_level =
        (T_map_base_.linear() * R_level_base.transpose()).topLeftCorner<2, 2>();
    static const double gate = quantile(boost::math::chi_squared(2), kSameTilt);
    Tilt tilt;
    tilt.mean = logSO3(R_level_base).head<2>();
    if (tilt.mean.squaredNorm() > gate * variance_) return std::nullopt;
    const Matrix62 of_tilt = information_.inverse().middleCols<2>(3) * R_map_level;
    tilt.covariance = R_map_level.transpose() * of_tilt.middleRows<2>(3);
    for (const Sight& each : sights_)
      tilt.cross.push_back(each.mapped ? Matrix62(-each.covariance * weigh(each).by_sight * of_tilt)
                                       : Matrix62(Matrix62::Zero()));
    return tilt;
  }

 private:
  static constexpr int kSteps = 6;

  static Matrix3d uprightOf(const Vector3d& from, const Vector3d& to) {
    return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
  }

  struct Weighed {
    Matrix6d information;  // of the pose of the base
    Vector6d right;        // of the normal equations
    Matrix6d by_sight;     // derivative of right by the error of the sight, transposed
  };
  Weighed weigh(const Sight& sight) const {
    static const double usual = quantile(boost::math::chi_squared(6), kUsual);
    const Pose T_map_marker = T_map_base_ * sight.T_base_marker;
    const Vector6d error = poseError(sight.mapped->T_map_marker, T_map_marker);
    Matrix6d turn = Matrix6d::Zero(), H = Matrix6d::Identity();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = T_map_base_.linear();
    H.topRightCorner<3, 3>() = -skew(T_map_marker.translation() - T_map_base_.translation());
    const Matrix6d noise = turn * sight.covariance * turn.transpose() + sight.mapped->covariance +
                           kMinSigma * kMinSigma * Matrix6d::Identity();
    const Matrix6d inverse = noise.inverse();
    const double weight = std::min(1.0, std::sqrt(usual / std::max(usual, error.dot(inverse * error))));
    const Matrix6d HW = weight * H.transpose() * inverse;
    return {HW * H, HW * error, (HW * turn).transpose()};
  }

  Vector6d step() {
    information_.setZero();
    information_.block<2, 2>(3, 3).diagonal().setConstant(1 / variance_);
    const Matrix3d R_level = uprightOf(Vector3d::UnitZ(), T_map_base_.linear().col(2));
    Vector6d right = Vector6d::Zero();
    right.segment<2>(3) = -logSO3(R_level).head<2>() / variance_;
    for (const Sight& each : sights_) {
      if (!each.mapped) continue;
      const Weighed one = weigh(each);
      information_ += one.information;
      right += one.right;
    }
    return information_.ldlt().solve(right);
  }

  const std::vector<Sight>& sights_;
  double variance_;
  Pose T_map_base_;
  Matrix6d information_;
};

/// By the mapped markers if the robot may be on a ramp.
Tilt tiltOf(const std::vector<Sight>& sights, const MarkerLandmarkParams& params) {
  const double variance = params.tilt_sigma * params.tilt_sigma + params.ramp_sigma * params.ramp_sigma;
  const auto is_mapped = [](const Sight& each) { return each.mapped != nullptr; };
  if (params.ramp_sigma > 0 && std::any_of(sights.begin(), sights.end(), is_mapped))
    if (const auto measured = SlopeFit(sights, variance).tilt()) return *measured;
  Tilt tilt;
  tilt.covariance = variance * Eigen::Matrix2d::Identity();
  tilt.cross.assign(sights.size(), Matrix62::Zero());
  return tilt;
}

Observation2D observation(const Sight& sight, const Tilt& tilt, const Matrix62& cross, bool has_heading) {
  const Pose T_level_marker = Pose(expSO3({tilt.mean.x(), tilt.mean.y(), 0})) * sight.T_base_marker;
  const Eigen::Matrix<double, 3, 6> J = planeJacobian(T_level_marker.linear());
  Eigen::Matrix<double, 6, 3> by_rotation;  // a rotation of the base moves and rotates the marker
  by_rotation << -skew(T_level_marker.translation()), Matrix3d::Identity();
  Eigen::Matrix<double, 3, 8> jacobian;
  jacobian << J, (J * by_rotation).leftCols<2>();
  Eigen::Matrix<double, 8, 8> covariance;
  covariance << sight.covariance, cross, cross.transpose(), tilt.covariance;
  Observation2D seen{T_level_marker.translation().head<2>(), {}, Matrix3d::Zero()};
  seen.covariance = jacobian * covariance * jacobian.transpose();
  if (has_heading) seen.heading = headingOf(T_level_marker.linear());
  return seen;
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
      {"ramp_sigma", &ramp_sigma, Range::closed(0, 0.5), "rad",
       "printed markers: standard deviation of the slope of ramps, added to `tilt_sigma`; above 0, "
       "unambiguous markers of a marker map also measure the [slope below the "
       "robot](../how_to/landmarks.md#printed-markers)"},
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

std::vector<LabelledObservation> markerObservations(const std::vector<SeenMarker>& markers,
                                                    const Pose& T_base_camera,
                                                    const MarkerLandmarkParams& params,
                                                    const MarkerMap* map) {
  const auto is_unambiguous = [&](const SeenMarker& marker) {
    return marker.alternative_probability <= 1 - params.heading_min_probability;
  };
  Matrix6d turned = Matrix6d::Zero();  // from the axes of the camera to those of the base
  turned.topLeftCorner<3, 3>() = turned.bottomRightCorner<3, 3>() = T_base_camera.linear();
  std::vector<Sight> sights;
  for (const SeenMarker& each : markers) {
    const bool is_used = map && is_unambiguous(each) && isCovariance(each.covariance);
    sights.push_back({T_base_camera * each.T_camera_marker, turned * each.covariance * turned.transpose(),
                      is_used ? map->find(each.key) : nullptr});
  }
  const Tilt tilt = tiltOf(sights, params);
  std::vector<LabelledObservation> seen;
  for (size_t i = 0; i < markers.size(); ++i) {
    const bool has_heading = is_unambiguous(markers[i]);
    seen.push_back({{markers[i].key.family, markers[i].key.id},
                    observation(sights[i], tilt, tilt.cross[i], has_heading),
                    has_heading});
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
