// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>

#include "sextant/geometry/camera.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

constexpr int kLensModes = 8;

/// Error of a camera's calibration, common to all its images: coefficients of lensModes(), pixels.
using LensCorrection = Eigen::Matrix<double, kLensModes, 1>;

/// Displacements of a pixel by errors of principal point, focal lengths, radial (r^3, r^5) and tangential
/// distortion (Brown 1971, "Close-range camera calibration"): polynomials of the pixel's position relative to
/// the centre of the image, in units of half its diagonal.
/// @param pixel projected by the calibration
Eigen::Matrix<double, 2, kLensModes> lensModes(const CameraModel& camera, const Eigen::Vector2d& pixel);
/// Jacobian of the displacement with respect to the pixel.
Eigen::Matrix2d lensJacobian(const CameraModel& camera, const Eigen::Vector2d& pixel,
                             const LensCorrection& lens);

/// Errors by MarkerView::camera_index; zero if a camera is not there.
using LensCorrections = std::map<size_t, LensCorrection>;

/// The corners that a camera without the error would see.
Corners correctedCorners(const CameraModel& camera, const Corners& corners, const LensCorrection& lens);
/// The same for all detections of an instant.
RecordedInstant correctedInstant(RecordedInstant instant, const LensCorrections& lenses);

/// Root mean square displacement over the image by an error, pixels.
double lensDisplacement(const CameraModel& camera, const LensCorrection& lens);

}  // namespace sextant
