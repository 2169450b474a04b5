// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/localization/corner_noise.hpp"
#include "sextant/localization/error_correction.hpp"
#include "sextant/localization/marker_locator.hpp"
#include "sextant/localization/moved_marker_detector.hpp"
#include "sextant/localization/odometry_correction.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Parameters of MarkerLocalization.
struct LocalizationParams {
  LocatorParams locator;    ///< parameters for the images of one instant
  OdometryParams odometry;  ///< parameters of the use of odometry between images
  bool estimate_noise = true;
  bool exclude_moved_markers = true;
  bool correct_errors = true;
  double readout_time = 0.0;

  ParamList fields();
};

/// Locates a robot in successive images: the algorithm of the locator node without ROS. Between images it
/// keeps T_map_odom, which resolves ambiguities and rejects outliers, the corner noise of each camera, the
/// systematic errors of calibration, shutter, marker size and map, and the markers that were moved.
class MarkerLocalization {
 public:
  /// @throws std::invalid_argument as validate(LocalizationParams).
  explicit MarkerLocalization(const LocalizationParams& params);

  /// Parameters given at construction.
  const LocalizationParams& params() const { return params_; }
  /// Changes the parameters and keeps the state. @throws as the constructor, without any change
  void setParams(const LocalizationParams& params);

  /// Locates the base.
  /// @param views detections at one instant, one view per camera; noise_scale is ignored if the noise is
  /// estimated
  /// @param T_odom_base odometry at that instant, if available
  /// @param stamp of the instant, seconds; without it, a rolling shutter is not found
  LocatorResult locate(const MarkerMap& map, const std::vector<MarkerView>& views,
                       const std::optional<Pose>& T_odom_base,
                       const std::optional<double>& stamp = std::nullopt);

  const OdometryCorrection& correction() const { return correction_; }        ///< filtered T_map_odom
  const MovedMarkerDetector& movedMarkers() const { return moved_markers_; }  ///< moved markers
  const CornerNoise& noise() const { return noise_; }                         ///< corner noise of each camera
  const ErrorMonitor& errors() const { return errors_.monitor(); }            ///< systematic errors found
  /// Resets everything that depends on the map; keeps the corner noise. To be called when the map changes.
  void resetMap();
  /// Resets everything. To be called when the clock jumps back.
  void reset();

 private:
  void findErrors(const MarkerMap& file, const ErrorCorrection::Images& images, LocatorResult& result);
  void replay(const MarkerMap& file);
  LocatorResult locateWithOdometry(const MarkerMap& map, std::vector<MarkerView>& views,
                                   const std::optional<Pose>& T_odom_base);
  LocatorResult locateWithNoise(const MarkerMap& map, std::vector<MarkerView>& views,
                                const std::optional<PosePrior>& prior);
  bool correctsErrors() const;
  bool estimatesNoise() const;
  LocatorResult gatedByOdometry(LocatorResult result, const Pose& T_odom_base);

  LocalizationParams params_;
  MarkerLocator locator_;
  OdometryCorrection correction_;
  MovedMarkerDetector moved_markers_;
  CornerNoise noise_;
  ErrorCorrection errors_;
};

}  // namespace sextant
