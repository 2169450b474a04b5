// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "sextant/geometry/pose2.hpp"
#include "sextant/landmarks/landmark_sensor.hpp"

namespace sextant {

/// Where a sensor has looked, in a grid of the map: there, unknown landmarks are improbable.
class ExploredArea {
 public:
  /// Counts a look at each position in view. One from nearly the same position as the last one that was
  /// counted is no new evidence, and is not counted.
  void look(const Pose2& T_map_sensor, const LandmarkSensor& sensor);

  /// Number of counted looks at a position in the map frame.
  int looks(const Eigen::Vector2d& position) const;

 private:
  using Index2 = Eigen::Array2i;
  struct Cell {
    Eigen::Vector2f from = Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
    int looks = 0;
  };
  Index2 indexOf(const Eigen::Vector2d& position) const;
  bool isInside(const Index2& index) const;
  size_t at(const Index2& index) const;
  bool growTo(const Index2& low, const Index2& high);

  double side_ = 0;                                      // of a cell, metres; 0: there is none yet
  Index2 low_ = Index2::Zero(), size_ = Index2::Zero();  // indices of the cells: the least, and their number
  std::vector<Cell> cells_;                              // by rows
};

}  // namespace sextant
