// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sextant/MarkerLocatorConfig.h"
#include "sextant/ros/localization/marker_locator_params.hpp"

namespace sextant {

/// The parameters that may change while the nodelet runs.
MarkerLocatorConfig toConfig(const MarkerLocatorParams& params);

/// @return params with the values of config
/// @throws std::invalid_argument that names the first value out of range
MarkerLocatorParams withConfig(const MarkerLocatorParams& params, const MarkerLocatorConfig& config);

}  // namespace sextant
