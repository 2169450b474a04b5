// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sextant/geometry/pose2.hpp"

namespace sextant {

/// Something that stands in the plane, in the map frame.
struct PlaneLandmark {
  Eigen::Vector2d position{0, 0};  ///< metres
  std::optional<double> heading;   ///< radians; a pillar has none

  int width() const { return heading ? 3 : 2; }
};

/// What kind of thing, and which of them where a sighting tells.
struct LandmarkLabel {
  std::string class_name;  ///< "blue_pillar", or the family of a printed marker
  std::optional<int> id;   ///< of a printed marker

  bool operator==(const LandmarkLabel& other) const {
    return class_name == other.class_name && id == other.id;
  }
};

/// What a sensor says of a landmark, in the robot frame.
struct PlaneSighting {
  Eigen::Vector2d position{0, 0};                        ///< metres
  std::optional<double> heading;                         ///< radians
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, heading)

  bool operator==(const PlaneSighting& other) const {
    return position == other.position && heading == other.heading && covariance == other.covariance;
  }
};

/// A sighting and what it is of.
struct LabelledSighting {
  LandmarkLabel label;
  PlaneSighting sighting;
  bool begins = true;  ///< whether it may be the first of a landmark

  bool operator==(const LabelledSighting& other) const {
    return label == other.label && sighting == other.sighting && begins == other.begins;
  }
};

/// A sighting without its heading.
struct LandmarkPointSighting {
  Eigen::Vector2d position;
  Eigen::Matrix2d covariance;  ///< of the sensor, in the axes of the position's frame
  LandmarkLabel label;
};

/// A sighting of a landmark that is known.
struct KnownSighting {
  size_t landmark;  ///< index
  PlaneSighting sighting;
};

/// A landmark of the map, in the robot frame.
PlaneLandmark seenFrom(const Pose2& T_map_base, const PlaneLandmark& landmark);

/// The rows (x, y[, heading]) that a sighting and its landmark have in common.
int commonWidth(const PlaneSighting& sighting, const PlaneLandmark& landmark);

/// Of sightings and what was expected of each, in the robot frame: the rows that they have in common, one
/// after another. Headings are wrapped.
Eigen::VectorXd differences(const std::vector<KnownSighting>& seen,
                            const std::vector<PlaneLandmark>& expected);

/// Covariance of those rows, each sighting by itself. @param landmarks all that are known
Eigen::MatrixXd noiseOf(const std::vector<KnownSighting>& seen, const std::vector<PlaneLandmark>& landmarks);

}  // namespace sextant
