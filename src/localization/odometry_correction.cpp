// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/odometry_correction.hpp"

#include <Eigen/Cholesky>

#include "sextant/geometry/odometry_drift.hpp"

namespace sextant {
namespace {

// What images of one place share (map, lens, print) does not average out: the filter forgets a little with
// every pose, so that at rest its variance stays near a tenth of theirs.
constexpr double kForgotten = 0.01;

Matrix6d drift(const OdometryParams& params, const Pose& step) {
  const double way = step.translation().norm(), turn = logSO3(step.linear()).norm();
  Vector6d variances;
  variances.head<3>().setConstant(driftVariance(params.position_drift, 0, way, turn));
  variances.tail<3>().setConstant(driftVariance(params.heading_drift, params.turn_drift, way, turn));
  return variances.asDiagonal();
}

}  // namespace

// p' = p + R dp: a rotation error r moves it by r x (R dp).
PosePrior movedByOdometry(const PosePrior& pose, const Pose& step, const OdometryParams& params) {
  Matrix6d F = Matrix6d::Identity();
  F.topRightCorner<3, 3>() = -skew(pose.T_map_base.linear() * step.translation());
  return {pose.T_map_base * step, F * pose.covariance * F.transpose() + drift(params, step)};
}

ParamList OdometryParams::fields() {
  return {
      {"position_drift", &position_drift, Range::openLow(0, 10), "m",
       "deviation of an axis after 1 m, growing with the root of the distance"},
      {"heading_drift", &heading_drift, Range::openLow(0, 10), "rad",
       "deviation of the rotation after 1 m, growing with the root of the distance"},
      {"turn_drift", &turn_drift, Range::openLow(0, 10), "rad",
       "deviation of the rotation after 1 rad of turning, growing with the root"},
      {"gate", &gate, Range::closed(12, 1e6), "",
       "squared Mahalanobis distance beyond which a pose contradicts the odometry and is not published"},
      {"recovery", &recovery, Range::closed(1, 1000), "",
       "so many in a row that contradict the odometry but not one another are right: it was the odometry"},
  };
}

OdometryCorrection::OdometryCorrection(const OdometryParams& params) : params_(params) { validate(params_); }

void OdometryCorrection::setParams(const OdometryParams& params) {
  validate(params);
  params_ = params;
}

PosePrior OdometryCorrection::moved(const State& state, const Pose& T_odom_base) const {
  return movedByOdometry({state.T_map_base, state.covariance}, state.T_odom_base.inverse() * T_odom_base,
                         params_);
}

bool OdometryCorrection::apart(const PosePrior& expected, const Pose& T_map_base,
                               const Matrix6d& covariance) const {
  const Vector6d innovation = poseError(T_map_base, expected.T_map_base);
  const Matrix6d S = expected.covariance + covariance;
  return !(innovation.dot(S.ldlt().solve(innovation)) <= params_.gate);
}

std::optional<PosePrior> OdometryCorrection::predict(const Pose& T_odom_base) const {
  if (!state_) return std::nullopt;
  return moved(*state_, T_odom_base);
}

bool OdometryCorrection::contradicts(const Pose& T_odom_base, const Pose& T_map_base,
                                     const Matrix6d& covariance) const {
  return state_ && apart(moved(*state_, T_odom_base), T_map_base, covariance);
}

OdometryCorrection::Verdict OdometryCorrection::update(const Pose& T_odom_base, const Pose& T_map_base,
                                                       const Matrix6d& covariance) {
  const State measured{T_odom_base, T_map_base, covariance};
  if (contradicts(T_odom_base, T_map_base, covariance)) return refuse(measured);
  refused_.reset();
  refusals_ = 0;
  if (!state_) {
    state_ = measured;
    return Verdict::taken;
  }
  const PosePrior prior = moved(*state_, T_odom_base);
  const Matrix6d S = prior.covariance + covariance;
  const Matrix6d K = S.ldlt().solve(prior.covariance).transpose();
  const Matrix6d rest = Matrix6d::Identity() - K;
  state_->T_odom_base = T_odom_base;
  state_->T_map_base = perturbed(prior.T_map_base, K * poseError(T_map_base, prior.T_map_base));
  state_->covariance =
      rest * prior.covariance * rest.transpose() + K * covariance * K.transpose() + kForgotten * covariance;
  return Verdict::taken;
}

OdometryCorrection::Verdict OdometryCorrection::refuse(const State& measured) {
  const bool agrees =
      refused_ && !apart(moved(*refused_, measured.T_odom_base), measured.T_map_base, measured.covariance);
  refusals_ = agrees ? refusals_ + 1 : 1;
  refused_ = measured;
  if (refusals_ < params_.recovery) return Verdict::contradicts;
  reset();
  state_ = measured;
  return Verdict::recovered;
}

std::optional<Pose> OdometryCorrection::transform() const {
  if (!state_) return std::nullopt;
  return state_->T_map_base * state_->T_odom_base.inverse();
}

void OdometryCorrection::reset() {
  state_.reset();
  refused_.reset();
  refusals_ = 0;
}

}  // namespace sextant
