// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/localization/corner_noise.hpp"
#include "sextant/localization/marker_locator.hpp"
#include "sextant/localization/marker_watch.hpp"
#include "sextant/localization/odometry_correction.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

struct LocalizationParams {
  LocatorParams locator;
  OdometryParams odometry;
  bool estimate_noise = true;
  bool leave_out_moved = true;

  ParamList fields();
};

/// Locates a robot image by image: what a node does with its markers, without ROS. Remembers what an image
/// alone does not tell: the last pose, moved by odometry, which decides between two poses and refuses false
/// ones; the cameras' noise; markers that stand elsewhere than the map says.
class MarkerLocalization {
 public:
  /// @throws std::invalid_argument as validate(LocalizationParams).
  explicit MarkerLocalization(const LocalizationParams& params);

  const LocalizationParams& params() const { return params_; }
  /// Keeps what is remembered. @throws as the constructor, and changes nothing then
  void setParams(const LocalizationParams& params);

  /// @param views of one instant, one a camera
  /// @param T_odom_base odometry at that instant, where there is some
  LocatorResult locate(const MarkerMap& map, std::vector<MarkerView> views,
                       const std::optional<Pose>& T_odom_base);

  const OdometryCorrection& correction() const { return correction_; }
  const MarkerWatch& watch() const { return watch_; }
  const CornerNoise& noise() const { return noise_; }

  /// Another map: forgets all but the cameras' noise.
  void forgetMap();
  /// Forgets everything: a clock that jumped back.
  void reset();

 private:
  LocatorResult locateWithNoise(const MarkerMap& map, std::vector<MarkerView>& views,
                                const std::optional<PosePrior>& prior);
  bool estimatesNoise() const;
  LocatorResult judged(LocatorResult result, const Pose& T_odom_base);

  LocalizationParams params_;
  MarkerLocator locator_;
  OdometryCorrection correction_;
  MarkerWatch watch_;
  CornerNoise noise_;
};

}  // namespace sextant
