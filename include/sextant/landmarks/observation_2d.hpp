// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sextant/geometry/pose2.hpp"

namespace sextant {

/// A landmark in the plane, in the map frame.
struct Landmark2D {
  Eigen::Vector2d position{0, 0};  ///< metres
  std::optional<double> heading;   ///< radians; none for a pillar

  int dimension() const { return heading ? 3 : 2; }  ///< number of coordinates
};

/// Class of a landmark, and its id if it can be observed.
struct LandmarkLabel {
  std::string class_name;  ///< "blue_pillar", or the family of a printed marker
  std::optional<int> id;   ///< of a printed marker; none: unknown

  /// Exact comparison.
  bool operator==(const LandmarkLabel& other) const {
    return class_name == other.class_name && id == other.id;
  }
};

/// A measurement of a landmark in the robot frame.
struct Observation2D {
  Eigen::Vector2d position{0, 0};                        ///< metres
  std::optional<double> heading;                         ///< radians; none: not measured
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, heading)

  /// Exact comparison.
  bool operator==(const Observation2D& other) const {
    return position == other.position && heading == other.heading && covariance == other.covariance;
  }
};

/// An observation with the label of its landmark.
struct LabelledObservation {
  LandmarkLabel label;         ///< what was observed
  Observation2D observation;   ///< where it was observed
  bool can_initialize = true;  ///< whether it may initialize a landmark

  /// Exact comparison.
  bool operator==(const LabelledObservation& other) const {
    return label == other.label && observation == other.observation && can_initialize == other.can_initialize;
  }
};

/// An observation without its heading.
struct PositionObservation {
  Eigen::Vector2d position;    ///< metres
  Eigen::Matrix2d covariance;  ///< sensor noise, in the frame of the position
  LandmarkLabel label;         ///< what was observed
};

/// An observation of a landmark in the map.
struct AssociatedObservation {
  size_t landmark;            ///< its index
  Observation2D observation;  ///< range and bearing with their noise
};

/// Transforms a landmark from the map to the robot frame.
Landmark2D toRobotFrame(const Pose2& T_map_base, const Landmark2D& landmark);

/// Position of an observation in the map frame, with its noise.
PositionObservation inMap(const Pose2& T_map_base, const LabelledObservation& seen);

/// Transforms an observation and its covariance from frame b to frame a.
Observation2D operator*(const Pose2& T_a_b, const Observation2D& observation);

/// Logarithm of the density of a point, 1/m^2, if its errors are normal, but for a share of gross errors
/// whose deviations are larger. @param distance squared, by the covariance @param root_determinant of it, m^2
double logDensity(double distance, double root_determinant);

/// Number of rows (x, y[, heading]) that an observation and its landmark have in common.
int commonDimension(const Observation2D& observation, const Landmark2D& landmark);

/// Innovations in the robot frame: stacked differences of the rows that each observation and its prediction
/// have in common. Headings are wrapped.
Eigen::VectorXd innovations(const std::vector<AssociatedObservation>& observations,
                            const std::vector<Landmark2D>& predicted);

/// Block-diagonal covariance of the rows of innovations(). @param landmarks all of the map
Eigen::MatrixXd observationNoise(const std::vector<AssociatedObservation>& observations,
                                 const std::vector<Landmark2D>& landmarks);

}  // namespace sextant
