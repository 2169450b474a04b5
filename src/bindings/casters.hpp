// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

#include "sextant/markers/marker.hpp"
#include "sextant/geometry/pose.hpp"

namespace pybind11::detail {

/// A Pose is a 4 x 4 homogeneous matrix in Python.
template <>
struct type_caster<sextant::Pose> {
  PYBIND11_TYPE_CASTER(sextant::Pose, const_name("numpy.ndarray[float64[4, 4]]"));

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

/// Corners are a 4 x 2 matrix in Python.
template <>
struct type_caster<sextant::Corners> {
  using Matrix = Eigen::Matrix<double, 4, 2>;
  PYBIND11_TYPE_CASTER(sextant::Corners, const_name("numpy.ndarray[float64[4, 2]]"));

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

/// An image of 8-bit grey as a view, without a copy; it lives as long as the array does.
using ImageArray = pybind11::array_t<uint8_t, pybind11::array::c_style | pybind11::array::forcecast>;
cv::Mat imageFromArray(const ImageArray& array);
pybind11::array_t<uint8_t> arrayFromImage(const cv::Mat& image);
/// An image of 8-bit red, green and blue.
pybind11::array_t<uint8_t> arrayFromColour(const cv::Mat& image);

/// Rows of float32 or uint8 as a view, without a copy where they are continuous; it lives as long as the
/// array.
cv::Mat matrixFromArray(const pybind11::array& array);
pybind11::array arrayFromMatrix(const cv::Mat& matrix);

}  // namespace sextant
