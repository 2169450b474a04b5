// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/pose.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace sextant {
namespace {

constexpr double kMinNorm = 1e-6;  // of a quaternion; below it, its direction is rounding error

}  // namespace

Pose poseFromXyzRpy(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy) {
  using Axis = Eigen::Vector3d;
  const Eigen::Quaterniond q = Eigen::AngleAxisd(rpy.z(), Axis::UnitZ()) *
                               Eigen::AngleAxisd(rpy.y(), Axis::UnitY()) *
                               Eigen::AngleAxisd(rpy.x(), Axis::UnitX());
  Pose pose = Pose::Identity();
  pose.linear() = q.toRotationMatrix();
  pose.translation() = xyz;
  return pose;
}

Pose poseFromQuaternion(const Eigen::Vector3d& position, const Eigen::Quaterniond& q, double tolerance) {
  if (!position.allFinite() || !q.coeffs().allFinite())
    throw std::invalid_argument("position and quaternion must be finite");
  const double norm = q.norm();
  if (norm < kMinNorm || std::abs(norm - 1) > tolerance) {
    std::ostringstream text;
    text << "the quaternion is not a rotation: its norm is " << norm << ", not 1";
    throw std::invalid_argument(text.str());
  }
  Pose pose = Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

Eigen::Vector3d rpyFromRotation(const Eigen::Matrix3d& R) {
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cos_pitch);
  if (cos_pitch < 1e-9) return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};  // gimbal lock: roll is free
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d expSO3(const Eigen::Vector3d& delta) {
  const double angle = delta.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity() + skew(delta);
  return Eigen::AngleAxisd(angle, delta / angle).toRotationMatrix();
}

Eigen::Vector3d logSO3(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * q.vec() / q.w();
  return (std::copysign(2.0, q.w()) * std::atan2(sine, std::abs(q.w())) / sine) * q.vec();
}

Pose perturbed(const Pose& pose, const Vector6d& xi) {
  Pose moved = pose;
  moved.translation() += xi.head<3>();
  moved.linear() = expSO3(xi.tail<3>()) * pose.linear();
  return moved;
}

Vector6d poseError(const Pose& truth, const Pose& estimate) {
  Vector6d xi;
  xi << truth.translation() - estimate.translation(), logSO3(truth.linear() * estimate.linear().transpose());
  return xi;
}

Pose meanPose(const std::vector<Pose>& poses) {
  if (poses.empty()) throw std::invalid_argument("meanPose: there is no pose to average");
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (const Pose& pose : poses) {
    translation += pose.translation();
    const Eigen::Vector4d q = Eigen::Quaterniond(pose.linear()).coeffs();
    scatter += q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(scatter);
  Pose mean = Pose::Identity();
  mean.translation() = translation / static_cast<double>(poses.size());
  mean.linear() =
      Eigen::Quaterniond(Eigen::Vector4d(solver.eigenvectors().col(3))).normalized().toRotationMatrix();
  return mean;
}

bool isCovariance(const Matrix6d& matrix) {
  if (!matrix.allFinite() || (matrix - matrix.transpose()).norm() > 1e-9 * matrix.norm()) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(matrix, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] >= -1e-12 * std::max(1.0, solver.eigenvalues()[5]);
}

bool isFinite(const Pose& pose) { return pose.matrix().allFinite(); }

}  // namespace sextant
