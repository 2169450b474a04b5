// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/odometry_correction.hpp"

#include <Eigen/Cholesky>

#include "sextant/geometry/odometry_drift.hpp"

namespace sextant {
namespace {

// Errors that images from one position have in common (map, lens, print) do not average out. This fraction of
// the measurement's covariance is added in every update, so that at rest the variance of the filter stays
// near a tenth of the measurement's.
constexpr double kCommonError = 0.01;

// Covariance of an odometry step.
Matrix6d drift(const OdometryParams& params, const Pose& step) {
  const double distance = step.translation().norm(), turn = logSO3(step.linear()).norm();
  Vector6d variances;
  variances.head<3>().setConstant(driftVariance(params.position_drift, 0, distance, turn));
  variances.tail<3>().setConstant(driftVariance(params.heading_drift, params.turn_drift, distance, turn));
  return variances.asDiagonal();
}

}  // namespace

// F is the Jacobian of the moved pose with respect to the pose: from p' = p + R dp, a rotation error r causes
// a position error r x (R dp).
PosePrior movedByOdometry(const PosePrior& pose, const Pose& step, const OdometryParams& params) {
  Matrix6d F = Matrix6d::Identity();
  F.topRightCorner<3, 3>() = -skew(pose.T_map_base.linear() * step.translation());
  return {pose.T_map_base * step, F * pose.covariance * F.transpose() + drift(params, step)};
}

ParamList OdometryParams::fields() {
  return {
      {"position_drift", &position_drift, Range::openLow(0, 10), "m",
       "standard deviation of position along each axis after 1 m, growing with the square root of the "
       "distance"},
      {"heading_drift", &heading_drift, Range::openLow(0, 10), "rad",
       "standard deviation of rotation about each axis after 1 m, growing with the square root of the "
       "distance"},
      {"turn_drift", &turn_drift, Range::openLow(0, 10), "rad",
       "standard deviation of rotation about each axis after 1 rad, growing with the square root of the "
       "angle"},
      {"gate", &gate, Range::closed(12, 1e6), "",
       "squared Mahalanobis distance from the prediction beyond which a pose is rejected and not published"},
      {"max_rejections", &max_rejections, Range::closed(1, 1000), "",
       "number of consecutive rejected poses, consistent with each other, after which the filter restarts "
       "from the last of them"},
  };
}

OdometryCorrection::OdometryCorrection(const OdometryParams& params) : params_(params) { validate(params_); }

void OdometryCorrection::setParams(const OdometryParams& params) {
  validate(params);
  params_ = params;
}

PosePrior OdometryCorrection::predictFrom(const State& state, const Pose& T_odom_base) const {
  return movedByOdometry({state.T_map_base, state.covariance}, state.T_odom_base.inverse() * T_odom_base,
                         params_);
}

bool OdometryCorrection::isOutsideGate(const PosePrior& predicted, const Pose& T_map_base,
                                       const Matrix6d& covariance) const {
  const Vector6d innovation = poseError(T_map_base, predicted.T_map_base);
  const Matrix6d S = predicted.covariance + covariance;
  return !(innovation.dot(S.ldlt().solve(innovation)) <= params_.gate);
}

std::optional<PosePrior> OdometryCorrection::predict(const Pose& T_odom_base) const {
  if (!state_) return std::nullopt;
  return predictFrom(*state_, T_odom_base);
}

bool OdometryCorrection::contradicts(const Pose& T_odom_base, const Pose& T_map_base,
                                     const Matrix6d& covariance) const {
  return state_ && isOutsideGate(predictFrom(*state_, T_odom_base), T_map_base, covariance);
}

OdometryCorrection::Verdict OdometryCorrection::update(const Pose& T_odom_base, const Pose& T_map_base,
                                                       const Matrix6d& covariance) {
  const State measured{T_odom_base, T_map_base, covariance};
  if (contradicts(T_odom_base, T_map_base, covariance)) return reject(measured);
  rejected_.reset();
  rejections_ = 0;
  if (!state_) {
    start(measured);
    return Verdict::accepted;
  }
  const PosePrior prior = predictFrom(*state_, T_odom_base);
  const Matrix6d S = prior.covariance + covariance;
  const Matrix6d K = S.ldlt().solve(prior.covariance).transpose();
  const Matrix6d I_K = Matrix6d::Identity() - K;
  state_->T_odom_base = T_odom_base;
  state_->T_map_base = perturbed(prior.T_map_base, K * poseError(T_map_base, prior.T_map_base));
  state_->covariance =
      I_K * prior.covariance * I_K.transpose() + K * covariance * K.transpose() + kCommonError * covariance;
  return Verdict::accepted;
}

OdometryCorrection::Verdict OdometryCorrection::reject(const State& measured) {
  const bool agrees = rejected_ && !isOutsideGate(predictFrom(*rejected_, measured.T_odom_base),
                                                  measured.T_map_base, measured.covariance);
  rejections_ = agrees ? rejections_ + 1 : 1;
  rejected_ = measured;
  if (rejections_ < params_.max_rejections) return Verdict::rejected;
  reset();
  start(measured);
  return Verdict::recovered;
}

void OdometryCorrection::start(const State& measured) {
  state_ = measured;
  ++starts_;
}

std::optional<Pose> OdometryCorrection::transform() const {
  if (!state_) return std::nullopt;
  return state_->T_map_base * state_->T_odom_base.inverse();
}

void OdometryCorrection::reset() {
  state_.reset();
  rejected_.reset();
  rejections_ = 0;
}

}  // namespace sextant
