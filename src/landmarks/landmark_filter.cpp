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

// Variance, over that of the noise, that what is expected may have beyond what is linear, in one part of an
// update.
constexpr double kMostBent = 0.05;
constexpr int kMostParts = 50;
// Seconds per root of a second. A clock's offset is constant; how fast what is seen moves, by which it is
// found, is as noisy as odometry, and without this the filter would be surer of it than it can be.
constexpr double kClockDrift = 1e-3;
constexpr double kRounding = 1e-12;       // of the largest variance: the least that a repaired one has
constexpr double kLeastVariance = 1e-12;  // and where all are zero, squared metres and radians

constexpr double kSame = 1e-6;  // metres and radians that two landmarks that are one may differ by

// The error is right-invariant on SE_{1+n}(2) (Barrau and Bonnabel 2015, "An EKF-SLAM algorithm with
// consistency properties"): the heading's error turns robot and landmarks together about the origin, so that
// what no sighting observes is not learned from errors of linearization.

Vector2d turned(const Vector2d& position, double xi_heading, const Vector2d& xi) {
  return rotation2(xi_heading) * position + leftJacobian2(xi_heading) * xi;
}

Pose2 moved(const Pose2& pose, const Vector3d& xi) {
  return {turned(pose.position, xi(2), xi.head<2>()), wrapped(pose.heading + xi(2))};
}

PlaneLandmark moved(const PlaneLandmark& landmark, double xi_heading, const VectorXd& xi) {
  PlaneLandmark result{turned(landmark.position, xi_heading, xi.head<2>()), {}};
  if (landmark.heading) result.heading = wrapped(*landmark.heading + xi_heading + xi(2));
  return result;
}

// Of something at a position, (x, y[, heading]) = its own xi + lever * xi_heading, to the first order.
VectorXd lever(const Vector2d& position, int width) {
  VectorXd result = VectorXd::Ones(width);
  result.head<2>() = turnedLeft(position);
  return result;
}

// L^-1 B for a lower triangle L.
MatrixXd lowerInverseTimes(const MatrixXd& L, const MatrixXd& B) {
  return L.triangularView<Eigen::Lower>().solve(B);
}

// The largest variance of a covariance in units of another one's, whose factor is given.
double largestRatio(const MatrixXd& covariance, const Eigen::LLT<MatrixXd>& unit) {
  const MatrixXd half = unit.matrixL().solve(covariance);
  const MatrixXd whole = unit.matrixL().solve(half.transpose());
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(whole, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

// A with A A^T = the matrix, which may have no rank.
Matrix3d squareRoot(const Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> parts(matrix);
  return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace

ParamList LandmarkFilterParams::fields() {
  return {
      {"scale_sigma", &scale_sigma, Range::closed(0, 1), "",
       "deviation of odometry's scale at the start; 0: it is not estimated"},
      {"scale_drift", &scale_drift, Range::closed(0, 1), "",
       "of it after 1 m, growing with the root of the distance"},
      {"clock_sigma", &clock_sigma, Range::closed(0, 10), "s",
       "deviation of the sightings' clock offset; 0: it is not estimated"},
  };
}

LandmarkFilter::LandmarkFilter(const LandmarkFilterParams& params, const Pose2& T_map_base,
                               const Matrix3d& covariance)
    : params_(params) {
  validate(params);
  if (Eigen::LLT<Matrix3d>(covariance).info() != Eigen::Success)
    throw std::invalid_argument("the covariance of the first pose is not positive definite");
  Index size = 3;
  if (params.scale_sigma > 0) scale_at_ = size++;
  if (params.clock_sigma > 0) clock_at_ = size++;
  setState(T_map_base, {}, covariance);
}

Indices LandmarkFilter::indicesOf(size_t landmark) const {
  Indices found(state_.landmarks[landmark].width());
  std::iota(found.begin(), found.end(), offsets_[landmark]);
  return found;
}

Indices LandmarkFilter::indicesOf(const std::vector<size_t>& landmarks, bool with_clock) const {
  Indices found = kPose;
  if (with_clock && clock_at_ >= 0) found.push_back(clock_at_);
  for (const size_t landmark : landmarks)
    for (const Index index : indicesOf(landmark)) found.push_back(index);
  return found;
}

std::vector<size_t> LandmarkFilter::all() const {
  std::vector<size_t> landmarks(offsets_.size());
  std::iota(landmarks.begin(), landmarks.end(), size_t{0});
  return landmarks;
}

// ---- time

// The noise is felt where the step begins: X' = X exp(w) U.
void LandmarkFilter::predict(const OdometryStep& odometry, double duration) {
  MatrixXd G = MatrixXd::Zero(P_.size(), 3);
  G.topLeftCorner<2, 2>() = rotation2(state_.pose.heading);
  G.col(2) = -levers();
  G(2, 2) = 1;
  propagate(odometry.step);
  P_.addSquare(G * squareRoot(odometry.noise));
  if (scale_at_ >= 0) drift(scale_at_, params_.scale_drift * std::sqrt(odometry.way));
  if (clock_at_ >= 0) drift(clock_at_, kClockDrift * std::sqrt(duration));
  if (duration > 0) speed_ = {odometry.step.position / duration, odometry.step.heading / duration};
}

// A step moves the state and leaves the error as it is; only the error of the scale moves the position.
void LandmarkFilter::propagate(const Pose2& step) {
  const Vector2d way = rotation2(state_.pose.heading) * step.position;
  state_.pose = state_.pose * Pose2{state_.scale * step.position, step.heading};
  if (scale_at_ < 0) return;
  const Indices position{0, 1};
  MatrixXd columns = P_.columns(position);
  const VectorXd scale = P_.columns({scale_at_});
  const double variance = P_(scale_at_, scale_at_);
  columns += scale * way.transpose();
  columns.topRows<2>() += way * (scale.head<2>() + variance * way).transpose();
  P_.setColumns(position, columns);
}

void LandmarkFilter::drift(Index which, double deviation) {
  MatrixXd square = MatrixXd::Zero(P_.size(), 1);
  square(which) = deviation;
  P_.addSquare(square);
}

PlanePoseEstimate LandmarkFilter::ahead(const OdometryStep& odometry) const {
  const Eigen::Matrix2d R = rotation2(state_.pose.heading);
  const Pose2 step{state_.scale * odometry.step.position, odometry.step.heading};
  Matrix3d F = Matrix3d::Identity(), G = Matrix3d::Identity();
  F.topRightCorner<2, 1>() = turnedLeft(R * step.position);
  G.topLeftCorner<2, 2>() = R;
  const Matrix3d C = covariance(std::vector<size_t>{}) + G * odometry.noise * G.transpose();
  return {state_.pose * step, F * C * F.transpose()};
}

VectorXd LandmarkFilter::levers() const {
  VectorXd levers = VectorXd::Zero(P_.size());
  levers(indicesOf(all())) = leversOf(all());
  return levers;
}

VectorXd LandmarkFilter::leversOf(const std::vector<size_t>& landmarks) const {
  VectorXd levers = VectorXd::Zero(3 + 3 * static_cast<Index>(landmarks.size()));
  levers.head<2>() = lever(state_.pose.position, 2);
  Index size = 3;
  for (const size_t index : landmarks) {
    const PlaneLandmark& landmark = state_.landmarks[index];
    levers.segment(size, landmark.width()) = lever(landmark.position, landmark.width());
    size += landmark.width();
  }
  return levers.head(size);
}

// ---- sightings

MatrixXd LandmarkFilter::factor(const Indices& which) {
  Eigen::LLT<MatrixXd> cholesky(P_.block(which));
  while (cholesky.info() != Eigen::Success) {
    ++repairs_;
    const VectorXd variances = Eigen::SelfAdjointEigenSolver<MatrixXd>(P_.block(which)).eigenvalues();
    const double largest = variances.maxCoeff(), least = std::min(variances.minCoeff(), 0.0);
    const double lacking = (largest > 0 ? kRounding * largest : kLeastVariance) - least;
    MatrixXd more = MatrixXd::Zero(P_.size(), which.size());
    for (size_t k = 0; k < which.size(); ++k) more(which[k], k) = std::sqrt(lacking);
    P_.addSquare(more);
    cholesky.compute(P_.block(which));
  }
  return cholesky.matrixL();
}

std::vector<PlaneLandmark> LandmarkFilter::expected(const std::vector<size_t>& landmarks,
                                                    const VectorXd& xi) const {
  Pose2 pose = moved(state_.pose, xi.head<3>());
  Index at = 3;
  if (clock_at_ >= 0) {
    const double late = xi(at++);
    pose = pose * Pose2{late * speed_.position, late * speed_.heading};
  }
  std::vector<PlaneLandmark> found;
  for (const size_t index : landmarks) {
    const PlaneLandmark& landmark = state_.landmarks[index];
    found.push_back(seenFrom(pose, moved(landmark, xi(2), xi.segment(at, landmark.width()))));
    at += landmark.width();
  }
  return found;
}

void LandmarkFilter::update(const std::vector<KnownSighting>& seen) {
  update(seen, noiseOf(seen, state_.landmarks));
}

void LandmarkFilter::update(const std::vector<KnownSighting>& seen, const MatrixXd& noise) {
  if (seen.empty()) return;
  std::vector<size_t> landmarks;
  for (const KnownSighting& each : seen) {
    if (std::find(landmarks.begin(), landmarks.end(), each.landmark) != landmarks.end())
      throw std::invalid_argument("landmark " + std::to_string(each.landmark) + " is seen twice at once");
    landmarks.push_back(each.landmark);
  }
  fuse(indicesOf(landmarks, true), noise,
       [&](const VectorXd& xi) { return differences(seen, expected(landmarks, xi)); });
}

// Where the sightings are bent by more than their noise within what is not known, one step would claim too
// much. They are told in parts then, each seen from where the last one led: parts whose information sums to
// that of the whole, so that nothing changes where all is linear.
void LandmarkFilter::fuse(const Indices& which, const MatrixXd& R, const Innovation& innovation) {
  const Eigen::LLT<MatrixXd> noise(R);
  double left = 1;  // of the information
  for (int parts = 1; left > 0; ++parts) {
    const MatrixXd L = factor(which);
    const UnscentedMoments moments = unscentedTransform(L, innovation);
    const MatrixXd bent = moments.covariance - moments.slopes * moments.slopes.transpose();
    const double part = kMostBent / std::max(largestRatio(bent, noise), kMostBent);
    const bool is_last = part >= left || parts == kMostParts;
    if (left == 1) {
      nis_ = moments.mean.dot((moments.covariance + R).llt().solve(moments.mean));
      nis_width_ = static_cast<int>(moments.mean.size());
    }
    fusePart(which, L, moments, R / (is_last ? left : part));
    left = is_last ? 0 : left - part;
  }
}

// Textbook's update with the covariance of state and innovation, which has the other sign than that with the
// sighting.
void LandmarkFilter::fusePart(const Indices& which, const MatrixXd& L, const UnscentedMoments& moments,
                              const MatrixXd& R) {
  const Eigen::LLT<MatrixXd> root(moments.covariance + R);
  const MatrixXd along = lowerInverseTimes(L, P_.columns(which).transpose());
  const MatrixXd W = lowerInverseTimes(root.matrixL(), -moments.slopes * along).transpose();
  P_.addSquare(W, -1);
  correct(W * lowerInverseTimes(root.matrixL(), moments.mean));
}

void LandmarkFilter::correct(const VectorXd& xi) {
  state_.pose = moved(state_.pose, xi.head<3>());
  if (scale_at_ >= 0) state_.scale += xi(scale_at_);
  if (clock_at_ >= 0) state_.clock += xi(clock_at_);
  for (size_t i = 0; i < offsets_.size(); ++i) {
    PlaneLandmark& landmark = state_.landmarks[i];
    landmark = moved(landmark, xi(2), xi.segment(offsets_[i], landmark.width()));
  }
}

SightingPrediction LandmarkFilter::predicted(const std::vector<size_t>& landmarks, bool headings) {
  const Indices which = indicesOf(landmarks, true);
  const std::vector<PlaneLandmark> centre = expected(landmarks, VectorXd::Zero(which.size()));
  const auto rows = [&](const VectorXd& xi) {
    std::vector<double> all;
    const std::vector<PlaneLandmark> found = expected(landmarks, xi);
    for (size_t i = 0; i < found.size(); ++i) {
      all.insert(all.end(), {found[i].position.x(), found[i].position.y()});
      if (headings && found[i].heading)
        all.push_back(*centre[i].heading + wrapped(*found[i].heading - *centre[i].heading));
    }
    return VectorXd(Eigen::Map<VectorXd>(all.data(), all.size()));
  };
  const UnscentedMoments moments = unscentedTransform(factor(which), rows);
  return {moments.mean, moments.covariance};
}

// ---- landmarks that come and go

// l = p + R(heading) z: what is not known of robot and sighting goes into it.
size_t LandmarkFilter::add(const PlaneSighting& sighting) {
  const Eigen::Matrix2d R = rotation2(state_.pose.heading);
  PlaneLandmark landmark{state_.pose * sighting.position, {}};
  if (sighting.heading) landmark.heading = wrapped(state_.pose.heading + *sighting.heading);
  const Index width = landmark.width();

  MatrixXd G_pose = MatrixXd::Zero(width, 3), G_sighting = MatrixXd::Identity(width, width);
  G_pose.leftCols(2).setIdentity();
  G_pose.col(2).head<2>() = lever(state_.pose.position, 2) + turnedLeft(R * sighting.position);
  if (sighting.heading) G_pose(2, 2) = 1;
  G_pose.col(2) -= lever(landmark.position, width);
  G_sighting.topLeftCorner<2, 2>() = R;

  const MatrixXd noise =
      G_sighting * sighting.covariance.topLeftCorner(width, width) * G_sighting.transpose();
  const MatrixXd cross = G_pose * P_.columns(kPose).transpose();
  const MatrixXd block = G_pose * P_.block(kPose) * G_pose.transpose() + noise;
  offsets_.push_back(P_.size());
  P_.append(cross, block);
  state_.landmarks.push_back(landmark);
  return state_.landmarks.size() - 1;
}

void LandmarkFilter::remove(size_t landmark) {
  const Index width = state_.landmarks[landmark].width();
  P_.erase(offsets_[landmark], width);
  state_.landmarks.erase(state_.landmarks.begin() + landmark);
  offsets_.erase(offsets_.begin() + landmark);
  for (size_t i = landmark; i < offsets_.size(); ++i) offsets_[i] -= width;
}

void LandmarkFilter::merge(size_t kept, size_t other) {
  Indices which{2};
  for (const size_t landmark : {kept, other})
    for (const Index index : indicesOf(landmark)) which.push_back(index);
  const PlaneLandmark &a = state_.landmarks[kept], &b = state_.landmarks[other];
  const bool with_headings = a.heading && b.heading;
  const Index width = with_headings ? 3 : 2;
  fuse(which, kSame * kSame * MatrixXd::Identity(width, width), [&](const VectorXd& xi) {
    const PlaneLandmark A = moved(a, xi(0), xi.segment(1, a.width())),
                        B = moved(b, xi(0), xi.tail(b.width()));
    VectorXd apart(width);
    apart.head<2>() = B.position - A.position;
    if (with_headings) apart(2) = wrapped(*B.heading - *A.heading);
    return apart;
  });
  remove(other);
}

// ---- the map's axes

MatrixXd LandmarkFilter::sheared(double sign) const {
  const VectorXd along = sign * levers(), heading = P_.columns({2});
  return P_.full() + along * heading.transpose() + heading * along.transpose() +
         heading(2) * along * along.transpose();
}

MatrixXd LandmarkFilter::covariance() const { return covariance(all()); }

MatrixXd LandmarkFilter::covariance(const std::vector<size_t>& landmarks) const {
  const Indices which = indicesOf(landmarks);
  const VectorXd along = leversOf(landmarks);
  const MatrixXd block = P_.block(which);
  return block + along * block.row(2) + block.col(2) * along.transpose() +
         block(2, 2) * along * along.transpose();
}

void LandmarkFilter::setSheared(const MatrixXd& plain) {
  P_.assign(plain);
  P_.assign(sheared(-1));
}

void LandmarkFilter::setPose(const Pose2& T_map_base, const Matrix3d& covariance) {
  MatrixXd plain = sheared(1);
  plain.topRows(3).setZero();
  plain.leftCols(3).setZero();
  plain.topLeftCorner<3, 3>() = covariance;
  state_.pose = T_map_base;
  setSheared(plain);
}

void LandmarkFilter::setState(const Pose2& T_map_base, const std::vector<PlaneLandmark>& landmarks,
                              const MatrixXd& covariance) {
  const Index own = 3 + (scale_at_ >= 0) + (clock_at_ >= 0);
  std::vector<Index> offsets;
  Index size = own;
  for (const PlaneLandmark& landmark : landmarks) {
    offsets.push_back(size);
    size += landmark.width();
  }
  const Index needed = size - own + 3;
  if (covariance.rows() != needed || covariance.cols() != needed)
    throw std::invalid_argument("the covariance has " + std::to_string(covariance.rows()) +
                                " rows, pose and landmarks have " + std::to_string(needed));
  state_ = {T_map_base, 1, 0, landmarks};
  offsets_ = offsets;
  const Indices which = indicesOf(all());
  MatrixXd plain = MatrixXd::Zero(size, size);
  plain(which, which) = covariance;
  if (scale_at_ >= 0) plain(scale_at_, scale_at_) = params_.scale_sigma * params_.scale_sigma;
  if (clock_at_ >= 0) plain(clock_at_, clock_at_) = params_.clock_sigma * params_.clock_sigma;
  setSheared(plain);
}

}  // namespace sextant
