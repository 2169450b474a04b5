// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>

#include "sextant/geometry/pose.hpp"
#include "sextant/geometry/pose2.hpp"

namespace pybind11::detail {

// _() is const_name() of pybind11 2.8 and later, which keep it.

/// A Pose is a 4 x 4 homogeneous matrix in Python.
template <>
struct type_caster<sextant::Pose> {
  PYBIND11_TYPE_CASTER(sextant::Pose, _("numpy.ndarray[float64[4, 4]]"));

  bool load(handle source, bool convert) {
    type_caster<Eigen::Matrix4d> matrix;
    if (!matrix.load(source, convert)) return false;
    const Eigen::Matrix4d& T = matrix;
    const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
    const bool rigid = (R * R.transpose()).isIdentity(1e-6) && T.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
    if (!rigid && T.allFinite())
      throw value_error("a pose must be a rigid 4 x 4 matrix: rotation, translation, 0 0 0 1");
    value.matrix() = T;
    return true;
  }

  static handle cast(const sextant::Pose& pose, return_value_policy, handle parent) {
    return type_caster<Eigen::Matrix4d>::cast(Eigen::Matrix4d(pose.matrix()), return_value_policy::move,
                                              parent);
  }
};

/// A Pose2 is (3,) x, y, heading in Python: metres, radians.
template <>
struct type_caster<sextant::Pose2> {
  PYBIND11_TYPE_CASTER(sextant::Pose2, _("numpy.ndarray[float64[3]]"));

  bool load(handle source, bool convert) {
    type_caster<Eigen::Vector3d> vector;
    if (!vector.load(source, convert)) return false;
    const Eigen::Vector3d& xyh = vector;
    value = {xyh.head<2>(), xyh(2)};
    return true;
  }

  static handle cast(const sextant::Pose2& pose, return_value_policy, handle parent) {
    return type_caster<Eigen::Vector3d>::cast(
        Eigen::Vector3d(pose.position.x(), pose.position.y(), pose.heading), return_value_policy::move,
        parent);
  }
};

}  // namespace pybind11::detail
