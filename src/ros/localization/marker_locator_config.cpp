// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/localization/marker_locator_config.hpp"

namespace sextant {
namespace {

// Which member is which value, for both ways.
template <typename Params, typename Config, typename Assign>
void pairUp(Params& params, Config& config, Assign assign) {
  assign(params.localization.locator.mode, config.mode);
  assign(params.localization.locator.corner_sigma, config.corner_sigma);
  assign(params.localization.locator.max_reprojection_error, config.max_reprojection_error);
  assign(params.localization.locator.robust_width, config.robust_width);
  assign(params.localization.locator.gate, config.gate);
  assign(params.localization.locator.floor_height_sigma, config.floor_height_sigma);
  assign(params.localization.locator.floor_tilt_sigma, config.floor_tilt_sigma);
  assign(params.localization.locator.decided, config.decided);
  assign(params.localization.locator.ambiguous, config.ambiguous);
  assign(params.localization.estimate_noise, config.estimate_noise);
  assign(params.localization.leave_out_moved, config.leave_out_moved);
  assign(params.localization.odometry.position_drift, config.odometry_position_drift);
  assign(params.localization.odometry.heading_drift, config.odometry_heading_drift);
  assign(params.localization.odometry.turn_drift, config.odometry_turn_drift);
  assign(params.localization.odometry.gate, config.odometry_gate);
  assign(params.localization.odometry.recovery, config.odometry_recovery);
  assign(params.transform_timeout, config.transform_timeout);
}

}  // namespace

MarkerLocatorConfig toConfig(const MarkerLocatorParams& params) {
  MarkerLocatorConfig config = MarkerLocatorConfig::__getDefault__();
  pairUp(params, config, [](const auto& member, auto& value) { value = member; });
  return config;
}

MarkerLocatorParams withConfig(const MarkerLocatorParams& params, const MarkerLocatorConfig& config) {
  MarkerLocatorParams changed = params;
  pairUp(changed, config, [](auto& member, const auto& value) { member = value; });
  changed.validate();
  return changed;
}

}  // namespace sextant
