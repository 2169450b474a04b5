// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace sextant {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

const Indices kPose{0, 1, 2};

// Maximum nonlinear innovation variance over noise variance per partial update.
constexpr double kMaxNonlinearity = 0.05;
constexpr int kMaxParts = 50;
// Process noise of the clock offset, seconds per root second. The offset is constant, but it is observed
// through velocities that are as noisy as odometry; without process noise its variance would become too
// small.
constexpr double kClockDrift = 1e-3;
constexpr double kRounding = 1e-12;     // minimum eigenvalue of a repaired covariance over its largest
constexpr double kMinVariance = 1e-12;  // minimum if all are zero, square metres and radians

constexpr double kMergeSigma = 1e-6;  // metres and radians between two landmarks that are merged

// The error is right-invariant on SE_{1+n}(2) (Barrau and Bonnabel 2015, "An EKF-SLAM algorithm with
// consistency properties"): the heading error rotates robot and landmarks together about the origin, so that
// linearization errors do not make unobservable directions appear observable.

Vector2d turned(const Vector2d& position, double xi_heading, const Vector2d& xi) {
  return rotation2(xi_heading) * position + leftJacobian2(xi_heading) * xi;
}

Pose2 moved(const Pose2& pose, const Vector3d& xi) {
  return {turned(pose.position, xi(2), xi.head<2>()), wrapped(pose.heading + xi(2))};
}

Landmark2D moved(const Landmark2D& landmark, double xi_heading, const VectorXd& xi) {
  Landmark2D result{turned(landmark.position, xi_heading, xi.head<2>()), {}};
  if (landmark.heading) result.heading = wrapped(*landmark.heading + xi_heading + xi(2));
  return result;
}

// Map-frame error (x, y[, heading]) at a position = own xi + headingColumn * xi_heading, to first order.
VectorXd headingColumn(const Vector2d& position, int width) {
  VectorXd result = VectorXd::Ones(width);
  result.head<2>() = perpendicular(position);
  return result;
}

// L^-1 B for a lower triangle L.
MatrixXd lowerInverseTimes(const MatrixXd& L, const MatrixXd& B) {
  return L.triangularView<Eigen::Lower>().solve(B);
}

// Largest eigenvalue of a covariance relative to another one, given by its Cholesky factor.
double largestRatio(const MatrixXd& covariance, const Eigen::LLT<MatrixXd>& unit) {
  const MatrixXd half = unit.matrixL().solve(covariance);
  const MatrixXd whole = unit.matrixL().solve(half.transpose());
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(whole, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

// A with A A^T = matrix, which may be singular.
Matrix3d squareRoot(const Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> parts(matrix);
  return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace

ParamList LandmarkFilterParams::fields() {
  return {
      {"scale_sigma", &scale_sigma, Range::closed(0, 1), "",
       "initial standard deviation of the scale of odometry; 0: not estimated"},
      {"scale_drift", &scale_drift, Range::closed(0, 1), "",
       "standard deviation of the scale's random walk after 1 m, growing with the square root of the "
       "distance"},
      {"turn_scale_sigma", &turn_scale_sigma, Range::closed(0, 1), "",
       "initial standard deviation of the scale of odometry's angles; 0: not estimated"},
      {"clock_sigma", &clock_sigma, Range::closed(0, 10), "s",
       "initial standard deviation of the clock offset of observations; 0: not estimated"},
      {"bearing_sigma", &bearing_sigma, Range::closed(0, 1), "rad",
       "initial standard deviation of an angle that is added to the bearings of observations, the error of "
       "the mount of the only sensor; 0: not estimated"},
  };
}

LandmarkFilter::LandmarkFilter(const LandmarkFilterParams& params, const Pose2& T_map_base,
                               const Matrix3d& covariance)
    : params_(params) {
  validate(params);
  if (Eigen::LLT<Matrix3d>(covariance).info() != Eigen::Success)
    throw std::invalid_argument("the covariance of the initial pose is not positive definite");
  Index size = 3;
  if (params.scale_sigma > 0) scale_index_ = size++;
  if (params.turn_scale_sigma > 0) turn_index_ = size++;
  if (params.clock_sigma > 0) clock_index_ = size++;
  if (params.bearing_sigma > 0) bearing_index_ = size++;
  setState(T_map_base, {}, covariance);
}

Indices LandmarkFilter::stateIndices(size_t landmark) const {
  Indices found(state_.landmarks[landmark].dimension());
  std::iota(found.begin(), found.end(), offsets_[landmark]);
  return found;
}

Indices LandmarkFilter::stateIndices(const std::vector<size_t>& landmarks, bool with_sensor) const {
  Indices found = kPose;
  for (const Index each : {clock_index_, bearing_index_})
    if (with_sensor && each >= 0) found.push_back(each);
  for (const size_t landmark : landmarks)
    for (const Index index : stateIndices(landmark)) found.push_back(index);
  return found;
}

std::vector<size_t> LandmarkFilter::all() const {
  std::vector<size_t> landmarks(offsets_.size());
  std::iota(landmarks.begin(), landmarks.end(), size_t{0});
  return landmarks;
}

// ---- prediction

// The noise w is in the frame at the beginning of the step: X' = X exp(w) U. The error is invariant under a
// step; only errors of the scales change it.
void LandmarkFilter::predict(const OdometryStep& odometry, double duration) {
  MatrixXd G = MatrixXd::Zero(P_.size(), 3);
  G.topLeftCorner<2, 2>() = rotation2(state_.pose.heading);
  G.col(2) = -headingJacobian();
  G(2, 2) = 1;
  P_.addSquare(G * squareRoot(odometry.noise));
  addCorrelated(G.leftCols<2>() * odometry.step.position, scale_index_);
  addCorrelated(G.col(2) * odometry.turn, turn_index_);
  const Pose2 step = scaled(odometry);
  state_.pose = state_.pose * step;
  if (scale_index_ >= 0) drift(scale_index_, params_.scale_drift * std::sqrt(odometry.distance));
  if (clock_index_ >= 0) drift(clock_index_, kClockDrift * std::sqrt(duration));
  if (duration > 0) velocity_ = {step.position / duration, step.heading / duration};
}

Pose2 LandmarkFilter::scaled(const OdometryStep& odometry) const {
  return {state_.scale * odometry.step.position,
          odometry.step.heading + (state_.turn_scale - 1) * odometry.turn};
}

/// Adds a multiple of the error of one element to that of all: xi' = xi + direction * xi(which), where the
/// direction of `which` is 0.
void LandmarkFilter::addCorrelated(const VectorXd& direction, Index which) {
  if (which < 0 || direction.isZero(0)) return;
  VectorXd other = P_.columns({which});
  other += 0.5 * other(which) * direction;
  if (other.isZero(0)) return;
  // a b^T + b a^T = (a + b)(a + b)^T / 2 - (a - b)(a - b)^T / 2, for vectors of equal length
  const double ratio = std::sqrt(other.norm() / direction.norm());
  const VectorXd a = std::sqrt(0.5) * ratio * direction, b = std::sqrt(0.5) / ratio * other;
  P_.addSquare(a + b);
  P_.addSquare(a - b, -1);
}

void LandmarkFilter::drift(Index which, double deviation) {
  MatrixXd square = MatrixXd::Zero(P_.size(), 1);
  square(which) = deviation;
  P_.addSquare(square);
}

PoseEstimate2D LandmarkFilter::predictPose(const OdometryStep& odometry) const {
  const Eigen::Matrix2d R = rotation2(state_.pose.heading);
  const Pose2 step = scaled(odometry);
  Matrix3d F = Matrix3d::Identity(), G = Matrix3d::Identity();
  F.topRightCorner<2, 1>() = perpendicular(R * step.position);
  G.topLeftCorner<2, 2>() = R;
  const Matrix3d C = covariance(std::vector<size_t>{}) + G * odometry.noise * G.transpose();
  return {state_.pose * step, F * C * F.transpose()};
}

VectorXd LandmarkFilter::headingJacobian() const {
  VectorXd jacobian = VectorXd::Zero(P_.size());
  const VectorXd values = headingJacobianOf(all());
  const Indices which = stateIndices(all());
  for (size_t k = 0; k < which.size(); ++k) jacobian(which[k]) = values(static_cast<Index>(k));
  return jacobian;
}

VectorXd LandmarkFilter::headingJacobianOf(const std::vector<size_t>& landmarks) const {
  VectorXd jacobian = VectorXd::Zero(3 + 3 * static_cast<Index>(landmarks.size()));
  jacobian.head<2>() = headingColumn(state_.pose.position, 2);
  Index size = 3;
  for (const size_t index : landmarks) {
    const Landmark2D& landmark = state_.landmarks[index];
    jacobian.segment(size, landmark.dimension()) = headingColumn(landmark.position, landmark.dimension());
    size += landmark.dimension();
  }
  return jacobian.head(size);
}

// ---- observations

MatrixXd LandmarkFilter::factor(const Indices& which) {
  Eigen::LLT<MatrixXd> cholesky(P_.block(which));
  while (cholesky.info() != Eigen::Success) {
    ++repairs_;
    const VectorXd variances = Eigen::SelfAdjointEigenSolver<MatrixXd>(P_.block(which)).eigenvalues();
    const double largest = variances.maxCoeff(), least = std::min(variances.minCoeff(), 0.0);
    const double lacking = (largest > 0 ? kRounding * largest : kMinVariance) - least;
    MatrixXd more = MatrixXd::Zero(P_.size(), which.size());
    for (size_t k = 0; k < which.size(); ++k) more(which[k], k) = std::sqrt(lacking);
    P_.addSquare(more);
    cholesky.compute(P_.block(which));
  }
  return cholesky.matrixL();
}

std::vector<Landmark2D> LandmarkFilter::predictedLandmarks(const std::vector<size_t>& landmarks,
                                                           const VectorXd& xi) const {
  Pose2 pose = moved(state_.pose, xi.head<3>());
  Index at = 3;
  if (clock_index_ >= 0) {
    const double offset = xi(at++);
    pose = pose * Pose2{offset * velocity_.position, offset * velocity_.heading};
  }
  if (bearing_index_ >= 0) pose.heading += xi(at++);
  std::vector<Landmark2D> predicted;
  for (const size_t index : landmarks) {
    const Landmark2D& landmark = state_.landmarks[index];
    predicted.push_back(toRobotFrame(pose, moved(landmark, xi(2), xi.segment(at, landmark.dimension()))));
    at += landmark.dimension();
  }
  return predicted;
}

void LandmarkFilter::update(const std::vector<AssociatedObservation>& observations) {
  update(observations, observationNoise(observations, state_.landmarks));
}

void LandmarkFilter::update(const std::vector<AssociatedObservation>& observations, const MatrixXd& noise) {
  if (observations.empty()) return;
  std::vector<size_t> landmarks;
  for (const AssociatedObservation& each : observations) {
    if (std::find(landmarks.begin(), landmarks.end(), each.landmark) != landmarks.end())
      throw std::invalid_argument("landmark " + std::to_string(each.landmark) +
                                  " is observed twice in one scan");
    landmarks.push_back(each.landmark);
  }
  fuse(stateIndices(landmarks, true), noise,
       [&](const VectorXd& xi) { return innovations(observations, predictedLandmarks(landmarks, xi)); });
}

// If the observation function is nonlinear by more than the noise within the state's uncertainty, one update
// would be overconfident. The information is then applied in parts, each linearized at the state after the
// last one. The parts add up to the full information, so that a linear update is unchanged.
void LandmarkFilter::fuse(const Indices& which, const MatrixXd& R, const Innovation& innovation) {
  const Eigen::LLT<MatrixXd> noise(R);
  double left = 1;  // share of the information that is not applied yet
  for (int parts = 1; left > 0; ++parts) {
    const MatrixXd L = factor(which);
    const UnscentedMoments moments = unscentedTransform(L, innovation);
    const MatrixXd nonlinear = moments.covariance - moments.slopes * moments.slopes.transpose();
    const double part = kMaxNonlinearity / std::max(largestRatio(nonlinear, noise), kMaxNonlinearity);
    const bool is_last = part >= left || parts == kMaxParts;
    if (left == 1) {
      const Eigen::LLT<MatrixXd> innovation_covariance(moments.covariance + R);
      nis_ = moments.mean.dot(innovation_covariance.solve(moments.mean));
      nis_dof_ = static_cast<int>(moments.mean.size());
      nis_state_share_ = innovation_covariance.solve(moments.covariance).trace() / nis_dof_;
    }
    fusePart(which, L, moments, R / (is_last ? left : part));
    left = is_last ? 0 : left - part;
  }
}

// Kalman update with the cross covariance of state and innovation, which has the opposite sign of that of
// state and observation.
void LandmarkFilter::fusePart(const Indices& which, const MatrixXd& L, const UnscentedMoments& moments,
                              const MatrixXd& R) {
  const Eigen::LLT<MatrixXd> root(moments.covariance + R);
  const MatrixXd whitened = lowerInverseTimes(L, P_.columns(which).transpose());
  const MatrixXd W = lowerInverseTimes(root.matrixL(), -moments.slopes * whitened).transpose();
  P_.addSquare(W, -1);
  correct(W * lowerInverseTimes(root.matrixL(), moments.mean));
}

void LandmarkFilter::correct(const VectorXd& xi) {
  state_.pose = moved(state_.pose, xi.head<3>());
  if (scale_index_ >= 0) state_.scale += xi(scale_index_);
  if (turn_index_ >= 0) state_.turn_scale += xi(turn_index_);
  if (clock_index_ >= 0) state_.clock += xi(clock_index_);
  if (bearing_index_ >= 0) state_.bearing += xi(bearing_index_);
  for (size_t i = 0; i < offsets_.size(); ++i) {
    Landmark2D& landmark = state_.landmarks[i];
    landmark = moved(landmark, xi(2), xi.segment(offsets_[i], landmark.dimension()));
  }
}

ObservationPrediction LandmarkFilter::predictObservations(const std::vector<size_t>& landmarks,
                                                          bool headings) {
  const Indices which = stateIndices(landmarks, true);
  const std::vector<Landmark2D> centre = predictedLandmarks(landmarks, VectorXd::Zero(which.size()));
  const auto rows = [&](const VectorXd& xi) {
    std::vector<double> all;
    const std::vector<Landmark2D> predicted = predictedLandmarks(landmarks, xi);
    for (size_t i = 0; i < predicted.size(); ++i) {
      all.insert(all.end(), {predicted[i].position.x(), predicted[i].position.y()});
      if (headings && predicted[i].heading)
        all.push_back(*centre[i].heading + wrapped(*predicted[i].heading - *centre[i].heading));
    }
    return VectorXd(Eigen::Map<VectorXd>(all.data(), all.size()));
  };
  const UnscentedMoments moments = unscentedTransform(factor(which), rows);
  return {moments.mean, moments.covariance};
}

// ---- adding and removing landmarks

// l = p + R(heading) z: the errors of robot and observation propagate to the landmark.
size_t LandmarkFilter::add(const Observation2D& observation) {
  const Eigen::Matrix2d R = rotation2(state_.pose.heading);
  Landmark2D landmark{state_.pose * observation.position, {}};
  if (observation.heading) landmark.heading = wrapped(state_.pose.heading + *observation.heading);
  const Index width = landmark.dimension();

  MatrixXd G_pose = MatrixXd::Zero(width, 3), G_observation = MatrixXd::Identity(width, width);
  G_pose.leftCols(2).setIdentity();
  G_pose.col(2).head<2>() = headingColumn(state_.pose.position, 2) + perpendicular(R * observation.position);
  if (observation.heading) G_pose(2, 2) = 1;
  G_pose.col(2) -= headingColumn(landmark.position, width);
  G_observation.topLeftCorner<2, 2>() = R;

  const MatrixXd noise =
      G_observation * observation.covariance.topLeftCorner(width, width) * G_observation.transpose();
  Indices which = kPose;
  if (bearing_index_ >= 0) {
    which.push_back(bearing_index_);
    G_pose.conservativeResize(width, 4);
    G_pose.col(3).setOnes();
    G_pose.col(3).head<2>() = perpendicular(R * observation.position);
  }
  const MatrixXd cross = G_pose * P_.columns(which).transpose();
  const MatrixXd block = G_pose * P_.block(which) * G_pose.transpose() + noise;
  offsets_.push_back(P_.size());
  P_.append(cross, block);
  state_.landmarks.push_back(landmark);
  return state_.landmarks.size() - 1;
}

void LandmarkFilter::remove(size_t landmark) {
  const Index width = state_.landmarks[landmark].dimension();
  P_.erase(offsets_[landmark], width);
  state_.landmarks.erase(state_.landmarks.begin() + landmark);
  offsets_.erase(offsets_.begin() + landmark);
  for (size_t i = landmark; i < offsets_.size(); ++i) offsets_[i] -= width;
}

void LandmarkFilter::merge(size_t kept, size_t other) {
  Indices which{2};
  for (const size_t landmark : {kept, other})
    for (const Index index : stateIndices(landmark)) which.push_back(index);
  const Landmark2D &a = state_.landmarks[kept], &b = state_.landmarks[other];
  const bool with_headings = a.heading && b.heading;
  const Index width = with_headings ? 3 : 2;
  fuse(which, kMergeSigma * kMergeSigma * MatrixXd::Identity(width, width), [&](const VectorXd& xi) {
    const Landmark2D A = moved(a, xi(0), xi.segment(1, a.dimension())),
                     B = moved(b, xi(0), xi.tail(b.dimension()));
    VectorXd apart(width);
    apart.head<2>() = B.position - A.position;
    if (with_headings) apart(2) = wrapped(*B.heading - *A.heading);
    return apart;
  });
  remove(other);
}

// ---- covariances in the map frame

MatrixXd LandmarkFilter::mapFrameCovariance(double sign) const {
  const VectorXd along = sign * headingJacobian(), heading = P_.columns({2});
  return P_.full() + along * heading.transpose() + heading * along.transpose() +
         heading(2) * along * along.transpose();
}

MatrixXd LandmarkFilter::covariance() const { return covariance(all()); }

MatrixXd LandmarkFilter::covariance(const std::vector<size_t>& landmarks) const {
  const Indices which = stateIndices(landmarks);
  const VectorXd along = headingJacobianOf(landmarks);
  const MatrixXd block = P_.block(which);
  return block + along * block.row(2) + block.col(2) * along.transpose() +
         block(2, 2) * along * along.transpose();
}

void LandmarkFilter::setMapFrameCovariance(const MatrixXd& covariance) {
  P_.assign(covariance);
  P_.assign(mapFrameCovariance(-1));
}

void LandmarkFilter::setPose(const Pose2& T_map_base, const Matrix3d& covariance) {
  MatrixXd plain = mapFrameCovariance(1);
  plain.topRows(3).setZero();
  plain.leftCols(3).setZero();
  plain.topLeftCorner<3, 3>() = covariance;
  state_.pose = T_map_base;
  setMapFrameCovariance(plain);
}

void LandmarkFilter::setState(const Pose2& T_map_base, const std::vector<Landmark2D>& landmarks,
                              const MatrixXd& covariance) {
  const std::vector<std::pair<Index, double>> calibration{{scale_index_, params_.scale_sigma},
                                                          {turn_index_, params_.turn_scale_sigma},
                                                          {clock_index_, params_.clock_sigma},
                                                          {bearing_index_, params_.bearing_sigma}};
  Index own = 3;
  for (const auto& each : calibration) own += each.first >= 0;
  std::vector<Index> offsets;
  Index size = own;
  for (const Landmark2D& landmark : landmarks) {
    offsets.push_back(size);
    size += landmark.dimension();
  }
  const Index needed = size - own + 3;
  if (covariance.rows() != needed || covariance.cols() != needed)
    throw std::invalid_argument("the covariance has " + std::to_string(covariance.rows()) +
                                " rows, pose and landmarks need " + std::to_string(needed));
  state_ = {T_map_base, 1, 1, 0, 0, landmarks};
  offsets_ = offsets;
  const Indices which = stateIndices(all());
  MatrixXd plain = MatrixXd::Zero(size, size);
  for (size_t k = 0; k < which.size(); ++k)
    for (size_t l = 0; l < which.size(); ++l) plain(which[k], which[l]) = covariance(k, l);
  for (const auto& [index, sigma] : calibration)
    if (index >= 0) plain(index, index) = sigma * sigma;
  setMapFrameCovariance(plain);
}

}  // namespace sextant
