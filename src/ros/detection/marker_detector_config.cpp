// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/detection/marker_detector_config.hpp"

namespace sextant {
namespace {

// Which member is which value, for both ways.
template <typename Params, typename Config, typename Assign>
void pairUp(Params& params, Config& config, Assign assign) {
  assign(params.detector.threads, config.threads);
  assign(params.detector.decimate, config.decimate);
  assign(params.detector.max_hamming, config.max_hamming);
  assign(params.detector.min_decision_margin, config.min_decision_margin);
  assign(params.detector.error_correction, config.error_correction);
  assign(params.detector.min_perimeter, config.min_perimeter);
  assign(params.detector.refine_corners, config.refine_corners);
  assign(params.sizes.size, config.marker_size);
  assign(params.corner_sigma, config.corner_sigma);
  assign(params.rate, config.rate);
  assign(params.debug_width, config.debug_width);
  assign(params.debug_rate, config.debug_rate);
  assign(params.debug_quality, config.debug_quality);
}

}  // namespace

MarkerDetectorConfig toConfig(const MarkerDetectorParams& params) {
  MarkerDetectorConfig config = MarkerDetectorConfig::__getDefault__();
  pairUp(params, config, [](const auto& member, auto& value) { value = member; });
  return config;
}

MarkerDetectorParams withConfig(const MarkerDetectorParams& params, const MarkerDetectorConfig& config) {
  MarkerDetectorParams changed = params;
  pairUp(changed, config, [](auto& member, const auto& value) { member = value; });
  changed.validate();
  return changed;
}

}  // namespace sextant
