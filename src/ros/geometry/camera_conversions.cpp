// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/geometry/camera_conversions.hpp"

#include <algorithm>

namespace sextant {
namespace {

// The centre of a binned pixel is the centre of the pixels that it combines.
double binned(double centre, double offset, double binning) {
  return (centre - offset + 0.5) / binning - 0.5;
}

}  // namespace

CameraCalibration fromMsg(const sensor_msgs::CameraInfo& info) {
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  const uint32_t bx = std::max(1u, info.binning_x), by = std::max(1u, info.binning_y);
  const bool whole = info.roi.width == 0 || info.roi.height == 0;
  CameraCalibration calibration;
  calibration.width = static_cast<int>((whole ? info.width : info.roi.width) / bx);
  calibration.height = static_cast<int>((whole ? info.height : info.roi.height) / by);
  calibration.distortion_model = info.distortion_model;
  calibration.D = info.D;
  calibration.K = Eigen::Map<const RowMajor3>(info.K.data());
  calibration.R = Eigen::Map<const RowMajor3>(info.R.data());
  calibration.P = Eigen::Map<const RowMajor34>(info.P.data());
  const auto adapt = [&](auto& matrix) {
    matrix.row(0) /= bx;
    matrix.row(1) /= by;
    matrix(0, 2) = binned(matrix(0, 2) * bx, whole ? 0 : info.roi.x_offset, bx);
    matrix(1, 2) = binned(matrix(1, 2) * by, whole ? 0 : info.roi.y_offset, by);
  };
  adapt(calibration.K);
  adapt(calibration.P);
  return calibration;
}

}  // namespace sextant
