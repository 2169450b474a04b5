// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>

#include "sextant/geometry/pose2.hpp"

namespace pybind11::detail {

/// A Pose2 is (3,) x, y, heading in Python: metres, radians.
template <>
struct type_caster<sextant::Pose2> {
  PYBIND11_TYPE_CASTER(sextant::Pose2, const_name("numpy.ndarray[float64[3]]"));

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
