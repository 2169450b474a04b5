// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sextant/MarkerDetectorConfig.h"
#include "sextant/ros/detection/marker_detector_params.hpp"

namespace sextant {

/// The parameters that may change while the nodelet runs.
MarkerDetectorConfig toConfig(const MarkerDetectorParams& params);

/// @return params with the values of config
/// @throws std::invalid_argument that names the first value out of range
MarkerDetectorParams withConfig(const MarkerDetectorParams& params, const MarkerDetectorConfig& config);

}  // namespace sextant
