// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "sextant/localization/error_monitor.hpp"
#include "sextant/localization/marker_locator.hpp"

namespace sextant {

/// A moving base.
struct Motion {
  Pose T_map_base;          ///< pose of the base in the map
  Vector6d velocity;        ///< position, rotation in the map's axes; per second
  Vector6d velocity_error;  ///< standard deviation along this direction
};

/// Finds systematic errors in the poses of successive images with an ErrorMonitor, and removes them from the
/// following images and their map.
class ErrorCorrection {
 public:
  /// @param readout_time of the cameras, seconds, if it is known; the monitor finds its error
  explicit ErrorCorrection(double readout_time) : readout_time_(readout_time) {}

  const ErrorMonitor& monitor() const { return monitor_; }  ///< the errors found

  /// The views with cameras without errors, and the corners where a camera without a rolling shutter would
  /// have seen them.
  /// @param motion pose and velocity at the images' stamp; nothing: the shutter is not corrected
  std::vector<MarkerView> corrected(const MarkerMap& map, std::vector<MarkerView> views,
                                    const std::optional<Motion>& motion) const;
  /// Motion at a stamp, seconds, by extrapolation of the last poses, or with the pose at this stamp.
  std::optional<Motion> motion(std::optional<double> stamp, const std::optional<Pose>& T_map_base) const;
  /// Whether a rolling shutter is corrected, which needs the motion.
  bool needsMotion() const;
  /// The mapped markers of these views, with their estimated size, and the covariance of an inexact map.
  MarkerMap corrected(const MarkerMap& map, const std::vector<MarkerView>& views) const;

  /// The images of one instant.
  struct Images {
    const std::vector<MarkerView>& views;      ///< as given
    const std::vector<MarkerView>& corrected;  ///< that gave the pose
    const MarkerMap& corrected_map;            ///< likewise
    std::optional<double> stamp;               ///< seconds
    std::optional<Motion> motion;              ///< with which they were corrected
  };
  /// Adds what the uncertainty of the errors contributes to the covariance of a pose, and gives its residuals
  /// to the monitor.
  /// @param map of the file; ignored: markers that were moved
  void add(const MarkerMap& map, const Images& images, double corner_sigma,
           const std::set<MarkerKey>& ignored, LocatedPose& pose);

  /// Locates in corrected views with a corrected map.
  using Locate = std::function<LocatorResult(const MarkerMap& map, std::vector<MarkerView>& views)>;
  /// If the monitor has accepted or dropped a cause: locates again in recent images, for the monitor. The
  /// errors are not small, so their effect on the residuals is linear only near their right values.
  void replay(const MarkerMap& map, double corner_sigma, const std::set<MarkerKey>& ignored,
              const Locate& locate);
  void evaluate() { monitor_.evaluate(); }                          ///< looks for causes now
  std::set<MarkerKey> takeMoved() { return monitor_.takeMoved(); }  ///< see ErrorMonitor

  void reset();  ///< forgets everything

 private:
  struct Instant {
    std::vector<MarkerView> views;  // uncorrected
    std::vector<MonitoredMarker> markers;
    Pose T_map_base;
    std::optional<double> stamp;
    double weight;
    std::optional<Vector6d> velocity;
  };
  CameraErrors errorsOf(size_t camera) const;
  static std::optional<Vector6d> velocity(const Instant& before, const Instant& after);
  double weightOf(const std::vector<MonitoredMarker>& markers, const std::vector<MarkerView>& views);
  void addCovariance(const std::vector<MonitoredMarker>& markers, const std::optional<Motion>& motion,
                     LocatedPose& pose) const;
  void finish(Instant instant);
  void keep(Instant instant);

  double readout_time_;
  ErrorMonitor monitor_;
  std::optional<Instant> before_, last_;  // the last two instants; the last one is not yet in the monitor
  std::deque<Instant> recent_;            // different views, for replay()
  std::map<MarkerKey, Corners> anchor_;   // of the view with which the following ones are compared
  int repetitions_ = 0;                   // images of the same view
};

}  // namespace sextant
