// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <vector>

#include "sextant/core/marker_locator.hpp"
#include "sextant/core/marker_map.hpp"

namespace sextant {

/// A marker that does not stand where the map has it.
struct MovedMarker {
  MarkerKey key;
  Eigen::Vector3d offset;  ///< where it is seen minus where the map has it, metres in the map's axes
  int images;              ///< in which it was left out
};

/// Finds markers that stand elsewhere than the map says: those that poses leave out for long.
class MarkerWatch {
 public:
  /// To be told every pose.
  void add(const LocatedPose& pose, const MarkerMap& map);

  /// Those that were left out of most of the last images that showed them, in order of their keys.
  std::vector<MovedMarker> moved() const;

  void reset() { seen_.clear(); }

 private:
  struct Seen {
    double images = 0.0, left_out = 0.0;  // of late: older ones fade
    int total_left_out = 0;
    double weight = 0.0;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // weighted sum
  };
  std::map<MarkerKey, Seen> seen_;
};

}  // namespace sextant
