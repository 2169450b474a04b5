// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sextant/geometry/camera.hpp"

namespace sextant {

/// Errors of a camera's calibration, and its rolling shutter: the true value minus that of the calibration.
struct CameraErrors {
  static constexpr int kCount = 5;  ///< number of errors

  double focal_length = 0.0;                         ///< fraction of the focal length
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< principal point, pixels
  double distortion = 0.0;                           ///< first radial coefficient k1
  double readout_time = 0.0;                         ///< seconds from the first to the last row

  /// As (focal_length, centre, distortion, readout_time).
  Eigen::Matrix<double, kCount, 1> vector() const;
  /// Inverse of vector().
  static CameraErrors fromVector(const Eigen::Matrix<double, kCount, 1>& values);
  bool areZero() const { return vector().isZero(0.0); }  ///< whether there is no error
};

/// Derivatives of a pixel with respect to CameraErrors::vector(); by the readout time, which depends on the
/// motion, zero.
Eigen::Matrix<double, 2, CameraErrors::kCount> cameraErrorJacobian(const CameraModel& camera,
                                                                   const Eigen::Vector2d& pixel);

/// Time at which a row is read, in readout times after the stamp of the image: that of its middle row.
double rowTime(const CameraModel& camera, double row);

/// Returns the camera of which these are the errors, without a rolling shutter.
CameraModel withErrors(const CameraModel& camera, const CameraErrors& errors);

}  // namespace sextant
