// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>

#include <string>
#include <utility>
#include <vector>

#include "sextant/markers/marker.hpp"

namespace pybind11::detail {

/// Corners are a 4 x 2 matrix in Python.
template <>
struct type_caster<sextant::Corners> {
  using Matrix = Eigen::Matrix<double, 4, 2>;
  PYBIND11_TYPE_CASTER(sextant::Corners, _("numpy.ndarray[float64[4, 2]]"));

  bool load(handle source, bool convert) {
    type_caster<Matrix> matrix;
    if (!matrix.load(source, convert)) return false;
    const Matrix& m = matrix;
    for (int i = 0; i < 4; ++i) value[i] = m.row(i);
    return true;
  }

  static handle cast(const sextant::Corners& corners, return_value_policy, handle parent) {
    Matrix m;
    for (int i = 0; i < 4; ++i) m.row(i) = corners[i];
    return type_caster<Matrix>::cast(m, return_value_policy::move, parent);
  }
};

}  // namespace pybind11::detail

namespace sextant {

/// Keys as tuples of family and id.
inline std::vector<std::pair<std::string, int>> pairs(const std::vector<MarkerKey>& keys) {
  std::vector<std::pair<std::string, int>> all;
  for (const MarkerKey& key : keys) all.emplace_back(key.family, key.id);
  return all;
}

}  // namespace sextant
