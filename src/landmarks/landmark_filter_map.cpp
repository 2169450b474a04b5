// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <numeric>
#include <stdexcept>
#include <string>

#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

constexpr double kSame = 1e-6;  // metres and radians that two landmarks that are one may differ by

}  // namespace

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
  MatrixXd cross = G_pose * P_.columns(poseIndices()).transpose();
  const MatrixXd block = G_pose * P_.block(poseIndices()) * G_pose.transpose() + noise;
  if (params_.init == "independent") cross.setZero();
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

std::vector<size_t> LandmarkFilter::all() const {
  std::vector<size_t> landmarks(offsets_.size());
  std::iota(landmarks.begin(), landmarks.end(), size_t{0});
  return landmarks;
}

Indices LandmarkFilter::told(const std::vector<size_t>& landmarks) const {
  Indices found = poseIndices();
  for (const size_t landmark : landmarks)
    for (const Index index : indicesOf(landmark)) found.push_back(index);
  return found;
}

MatrixXd LandmarkFilter::covariance(const std::vector<size_t>& landmarks) const {
  const Indices which = told(landmarks);
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
  const Indices which = told(all());
  MatrixXd plain = MatrixXd::Zero(size, size);
  plain(which, which) = covariance;
  if (scale_at_ >= 0) plain(scale_at_, scale_at_) = params_.scale_sigma * params_.scale_sigma;
  if (clock_at_ >= 0) plain(clock_at_, clock_at_) = params_.clock_sigma * params_.clock_sigma;
  setSheared(plain);
}

}  // namespace sextant
