// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// What a sensor sees, how surely, and what the things are like that it sees.
struct LandmarkSensorParams {
  double max_range = 5.0;
  double min_range = 0.0;
  double field_of_view = 1.0;
  double detection = 0.8;
  double phantom = 0.05;
  double width = 0.2;
  double separation = 0.3;

  ParamList fields();
};

/// Which landmarks a sensor should see.
class LandmarkSensor {
 public:
  /// @throws std::invalid_argument as validate(LandmarkSensorParams)
  explicit LandmarkSensor(const LandmarkSensorParams& params);

  /// Indices of those that are surely in view, wherever robot and landmarks may be, with no other in the way.
  /// @param T_base_sensor whose x axis is the middle of what it sees
  std::vector<size_t> surelyInView(const SightingPrediction& in_base, const Pose2& T_base_sensor = {}) const;

  /// What a sighting, and a look without one, adds to the log odds that a landmark is there (as of a grid
  /// map's cell: Thrun, Burgard and Fox 2005, section 4.2).
  double evidence(bool is_seen) const;

 private:
  bool isInView(const Eigen::Vector2d& position, double off) const;
  bool isHidden(const SightingPrediction& expected, Eigen::Index which) const;

  LandmarkSensorParams params_;
};

/// The largest deviation in any direction.
double largestDeviation(const Eigen::Matrix2d& covariance);

}  // namespace sextant
