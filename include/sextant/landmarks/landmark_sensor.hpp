// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// Field of view and detection model of a sensor, and the size of the landmarks.
struct LandmarkSensorParams {
  double max_range = 5.0;
  double min_range = 0.0;
  double field_of_view = 1.0;
  double detection_probability = 0.8;
  double false_alarm_probability = 0.05;
  double landmark_width = 0.2;
  double min_separation = 0.3;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// What a sensor detects.
enum class Detects {
  all,      ///< all landmarks in view
  with_id,  ///< only landmarks with an id, for instance printed markers: it misses no other one
};

/// Visibility and detection model of a sensor.
class LandmarkSensor {
 public:
  /// @throws std::invalid_argument as validate(LandmarkSensorParams)
  explicit LandmarkSensor(const LandmarkSensorParams& params);

  /// Indices of the landmarks that are in view and not occluded, whatever the errors of robot and landmarks.
  /// @param in_base predicted observations without headings @param T_base_sensor its x axis is the viewing
  /// direction
  std::vector<size_t> expectedInView(const ObservationPrediction& in_base,
                                     const Pose2& T_base_sensor = {}) const;

  /// Log odds that a detection or a missed detection adds to the existence of a landmark (inverse sensor
  /// model as of a cell of an occupancy grid: Thrun, Burgard and Fox 2005, section 4.2).
  double evidence(bool is_detected) const;

  /// Counts established landmarks that were expected in view, in scans that detected another one.
  void count(int detected, int missed);
  /// Detection probability: that of the parameters, corrected by the counts.
  double detectionProbability() const;
  double maxRange() const { return params_.max_range; }  ///< as in the parameters, metres

  /// Whether a position in the sensor frame is in view, whatever its error. @param off largest error, metres
  bool isInView(const Eigen::Vector2d& position, double off = 0) const;

 private:
  bool isOccluded(const ObservationPrediction& expected, Eigen::Index which) const;

  LandmarkSensorParams params_;
  double detected_ = 0, expected_ = 0;  // counted landmarks
};

/// Whether a landmark is seen from another direction than before: only then a miss is new evidence.
/// @param last position of the earlier view @param from that of this one
bool isNewView(const Eigen::Vector2d& last, const Eigen::Vector2d& from, const Eigen::Vector2d& landmark);

/// Largest standard deviation in any direction.
double largestDeviation(const Eigen::Matrix2d& covariance);

}  // namespace sextant
