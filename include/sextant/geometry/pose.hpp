// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "sextant/geometry/eigen_solvers.hpp"

namespace sextant {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// T_a_b takes coordinates in frame b to coordinates in frame a. Metres.
using Pose = Eigen::Isometry3d;

/// Pose from a translation in metres and fixed-axis roll, pitch, yaw in radians: R = Rz(yaw) Ry(pitch)
/// Rx(roll), as tf2's setRPY.
Pose poseFromXyzRpy(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy);

/// Pose from a position in metres and a quaternion; q and -q are the same.
/// @param tolerance by how much the quaternion's length may differ from 1
/// @throws std::invalid_argument for a number that is not finite, or another length
Pose poseFromQuaternion(const Eigen::Vector3d& position, const Eigen::Quaterniond& q,
                        double tolerance = 0.01);

/// Roll, pitch, yaw of R = Rz(yaw) Ry(pitch) Rx(roll); pitch in [-pi/2, pi/2].
Eigen::Vector3d rpyFromRotation(const Eigen::Matrix3d& rotation);

/// Cross-product matrix: skew(a) b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& vector);

/// Rotation by |delta| radians about delta (exponential map of SO(3), Rodrigues' formula).
Eigen::Matrix3d expSO3(const Eigen::Vector3d& delta);

/// Inverse of expSO3; the angle is in [0, pi].
Eigen::Vector3d logSO3(const Eigen::Matrix3d& rotation);

/// T moved by xi = (position, rotation), both in the axes of the parent frame: p + xi_p, Exp(xi_r) R.
Pose perturbed(const Pose& pose, const Vector6d& xi);

/// xi with truth = perturbed(estimate, xi): what a covariance of ours describes, and what NEES is computed
/// from.
Vector6d poseError(const Pose& truth, const Pose& estimate);

/// Mean of translations; rotations by the eigenvector mean of their quaternions (Markley et al. 2007,
/// "Averaging quaternions", eq. 12-13), so that q and -q are the same rotation.
/// @throws std::invalid_argument when there is nothing to average.
Pose meanPose(const std::vector<Pose>& poses);

/// Finite, symmetric and without a negative variance in any direction.
bool isCovariance(const Matrix6d& matrix);

/// All 16 numbers are finite.
bool isFinite(const Pose& pose);

}  // namespace sextant
