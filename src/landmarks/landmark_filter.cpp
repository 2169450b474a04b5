// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "matrix_factors.hpp"

namespace sextant {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Variance, over that of the noise, that what is expected may have beyond what is linear, in one part of an
// update.
constexpr double kMostBent = 0.05;
constexpr int kMostParts = 50;
// Seconds per root of a second. A clock's offset is constant; how fast what is seen moves, by which it is
// found, is as noisy as odometry, and without this the filter would be surer of it than it can be.
constexpr double kClockDrift = 1e-3;
constexpr double kRounding = 1e-12;       // of the largest variance: the least that a repaired one has
constexpr double kLeastVariance = 1e-12;  // and where all are zero, squared metres and radians

}  // namespace

LandmarkFilter::LandmarkFilter(const LandmarkFilterParams& params) : params_(params) {
  Index size = 3;
  if (params.scale_sigma > 0) scale_at_ = size++;
  if (params.clock_sigma > 0) clock_at_ = size++;
  P_.assign(MatrixXd::Zero(size, size));
}

Indices LandmarkFilter::indicesOf(size_t landmark) const {
  Indices found(state_.landmarks[landmark].width());
  std::iota(found.begin(), found.end(), offsets_[landmark]);
  return found;
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
  levers(told(all())) = leversOf(all());
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

Indices LandmarkFilter::subset(const std::vector<size_t>& landmarks) const {
  Indices found = poseIndices();
  if (clock_at_ >= 0) found.push_back(clock_at_);
  for (const size_t landmark : landmarks)
    for (const Index index : indicesOf(landmark)) found.push_back(index);
  return found;
}

Indices LandmarkFilter::withAllOthers(Indices which) const {
  std::vector<bool> is_there(P_.size(), false);
  for (const Index index : which) is_there[index] = true;
  for (Index index = 0; index < P_.size(); ++index)
    if (!is_there[index]) which.push_back(index);
  return which;
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
  const Indices known = subset(landmarks);
  fuse(params_.sigma_points == "all" ? withAllOthers(known) : known, noise,
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
    const UnscentedMoments moments = unscentedTransform(L, params_.points, innovation);
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
  const Indices which = subset(landmarks);
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
  const UnscentedMoments moments = unscentedTransform(factor(which), params_.points, rows);
  return {moments.mean, moments.covariance};
}

}  // namespace sextant
