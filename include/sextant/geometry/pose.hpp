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

/// Pose of a frame, as a transform in metres. T_a_b is the pose of frame b in frame a: p_a = T_a_b p_b.
using Pose = Eigen::Isometry3d;

/// Returns the pose with a translation in metres and fixed-axis roll, pitch, yaw in radians:
/// R = Rz(yaw) Ry(pitch) Rx(roll), as tf2's setRPY.
Pose poseFromXyzRpy(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy);

/// Returns the pose with a position in metres and a quaternion; q and -q give the same pose.
/// @param tolerance maximum difference of the quaternion's norm from 1
/// @throws std::invalid_argument for a number that is not finite, or a norm that differs more
Pose poseFromQuaternion(const Eigen::Vector3d& position, const Eigen::Quaterniond& q,
                        double tolerance = 0.01);

/// Returns roll, pitch, yaw in radians of R = Rz(yaw) Ry(pitch) Rx(roll); pitch is in [-pi/2, pi/2].
Eigen::Vector3d rpyFromRotation(const Eigen::Matrix3d& rotation);

/// Returns the cross-product matrix: skew(a) b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& vector);

/// Returns the rotation by |delta| radians about delta (exponential map of SO(3), Rodrigues' formula).
Eigen::Matrix3d expSO3(const Eigen::Vector3d& delta);

/// Inverts expSO3(); the angle |delta| is in [0, pi].
Eigen::Vector3d logSO3(const Eigen::Matrix3d& rotation);

/// Perturbs a pose by xi = (position, rotation), both in the axes of the parent frame: p + xi_p and
/// expSO3(xi_r) R.
Pose perturbed(const Pose& pose, const Vector6d& xi);

/// Returns the xi for which truth = perturbed(estimate, xi). Covariances of poses are those of this error,
/// and the NEES (normalized estimation error squared) is computed from it.
Vector6d poseError(const Pose& truth, const Pose& estimate);

/// Returns the mean of the translations and of the rotations: the eigenvector mean of the quaternions
/// (Markley et al. 2007, "Averaging quaternions", eq. 12-13), for which q and -q are the same rotation.
/// @throws std::invalid_argument for an empty list
Pose meanPose(const std::vector<Pose>& poses);

/// Whether a matrix is finite, symmetric and positive semidefinite.
bool isCovariance(const Matrix6d& matrix);

/// Whether all 16 numbers are finite.
bool isFinite(const Pose& pose);

}  // namespace sextant
