// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <vector>

#include "sextant/localization/marker_locator.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// A marker that does not stand where the map has it.
struct MovedMarker {
  MarkerKey key;
  Eigen::Vector3d offset;  ///< where it is seen minus where the map has it, metres in the map's axes
  int images;              ///< in which it was seen elsewhere
};

/// Finds markers that stand elsewhere than the map says: those that for long lie farther from where the other
/// markers of their images expect them than any other does. One at a time: until it is left out, it speaks
/// against those that are right.
class MarkerWatch {
 public:
  /// To be told every pose.
  void add(const LocatedPose& pose, const MarkerMap& map);

  /// In order of their keys.
  std::vector<MovedMarker> moved() const;
  /// Their keys, for MarkerLocator::locate.
  const std::set<MarkerKey>& distrusted() const { return distrusted_; }

  void reset();

 private:
  struct Seen {
    double images = 0.0, squares = 0.0;  // of late: older ones fade
    int elsewhere = 0;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d weighted = Eigen::Vector3d::Zero();  // information times offset

    double mean() const { return squares / images; }
    Eigen::Vector3d offset() const;
  };

  void judge();
  bool isMoved(const MarkerKey& key, const Seen& seen) const;
  double typical(const MarkerKey& but) const;

  std::map<MarkerKey, Seen> seen_;
  std::set<MarkerKey> distrusted_;
};

}  // namespace sextant
