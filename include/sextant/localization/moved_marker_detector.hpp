// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <vector>

#include "sextant/localization/marker_locator.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// A marker that is not at its position in the map.
struct MovedMarker {
  MarkerKey key;           ///< family and id
  Eigen::Vector3d offset;  ///< observed minus mapped position, metres in the map's axes
  int images;              ///< number of images that contradict the map
};

/// Watches markers that may have been moved from their position in the map: their mean squared innovation
/// (relative to the pose from the other markers) over the last images is large, absolutely and relative to
/// the median of the others. Whether a marker was moved, or something else explains the innovations, is
/// decided by an ErrorMonitor.
class MovedMarkerDetector {
 public:
  /// Adds the innovations of the markers of a pose; ignores poses from one marker. Returns whether a marker
  /// is suspected to have been moved; then not again until there are further images.
  bool add(const LocatedPose& pose, const MarkerMap& map);
  /// Marks a marker as moved, until it agrees with the map again.
  void exclude(const MarkerKey& key);

  /// Moved markers, sorted by key.
  std::vector<MovedMarker> moved() const;
  /// Keys of the moved markers, as `ignored` of MarkerLocator::locate().
  const std::set<MarkerKey>& keys() const { return keys_; }

  void reset();  ///< forgets all images

 private:
  struct Statistics {
    // Exponentially weighted sums: number of images, squared innovations, information of the offset, and
    // information times offset.
    double images = 0.0, squared_innovations = 0.0;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d weighted_offset = Eigen::Vector3d::Zero();
    int outliers = 0;  // images that contradict the map, not weighted

    double meanSquare() const { return squared_innovations / images; }
    Eigen::Vector3d offset() const;
    double offsetSigma() const;
  };

  bool updateKeys();
  void restart();
  bool isSuspect(const MarkerKey& key, const Statistics& statistics) const;
  double medianOfOthers(const MarkerKey& key) const;
  std::map<MarkerKey, Statistics> statistics_;
  std::set<MarkerKey> keys_;
};

}  // namespace sextant
