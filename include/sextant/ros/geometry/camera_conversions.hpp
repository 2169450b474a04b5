// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include "sextant/geometry/camera.hpp"

namespace sextant {

/// Converts the calibration to that of the published image: binning and region of interest are applied.
CameraCalibration fromMsg(const sensor_msgs::CameraInfo& info);

}  // namespace sextant
