// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sextant/images/camera_driver_node_params.hpp"

namespace sextant {

/// The properties of a camera, numbered as cv::VideoCaptureProperties.
struct CameraProperties {
  std::function<bool(int property, double value)> set;  ///< false: refused
  std::function<double(int property)> get;              ///< negative: not known
};

/// Checks that no control has a value and is automatic, too.
/// @throws std::invalid_argument with the name of the control
void requireOneMode(const CameraControlParams& params);

/// Whether any control is set.
bool hasControls(const CameraControlParams& params);

/// Sets the controls of an open camera, in the units of Video4Linux.
/// @return for each control that the camera refuses, or sets to another value, what it did, for the user
std::vector<std::string> applyControls(const CameraControlParams& params, const CameraProperties& camera);

}  // namespace sextant
