// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// What a sensor sees, how surely, and what the things are like that it sees.
struct LandmarkSensorParams {
  double max_range = 5.0;  ///< metres, (0, 1000]
  double min_range = 0.0;  ///< metres; what is nearer it may miss, [0, max_range]
  double field_of_view =
      1.0;                  ///< of all directions that it surely sees, about its x axis, radians, (0, 2 pi]
  double detection = 0.8;   ///< probability that it sees what is there, [0.01, 0.99]
  double phantom = 0.05;    ///< probability that a sighting is of nothing, [0.001, 0.5]
  double width = 0.2;       ///< of landmarks: what stands behind one is not seen, metres, [0, 100]
  double separation = 0.3;  ///< two landmarks of a class are never nearer, metres, [0, 100]

  /// @throws std::invalid_argument that names the first field out of range.
  void validate() const;
};

/// Which landmarks a sensor should see.
class LandmarkSensor {
 public:
  /// @throws std::invalid_argument as LandmarkSensorParams::validate()
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
