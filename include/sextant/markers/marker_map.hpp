// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// A marker whose place is known.
struct MappedMarker {
  MarkerKey key;
  double size = 0.0;  ///< edge length, metres
  std::string name;   ///< tf frame
  Pose T_map_marker = Pose::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< position, rotation in the map's axes (m^2, rad^2); zero: exact
};

/// A frame of the plain text format that is no marker, e.g. a camera mount.
struct MappedFrame {
  std::string name;
  std::string parent;
  Pose T_parent_frame = Pose::Identity();
};

/// Markers by family and id, in one frame.
class MarkerMap {
 public:
  explicit MarkerMap(std::string frame = "map") : frame_(std::move(frame)) {}

  const std::string& frame() const { return frame_; }
  const std::map<MarkerKey, MappedMarker>& markers() const { return markers_; }
  const std::vector<MappedFrame>& frames() const { return frames_; }

  /// @return nullptr for a marker that the map does not have
  const MappedMarker* find(const MarkerKey& key) const;

  /// Adds a marker; an empty name becomes "<family>/<id>".
  /// @throws std::invalid_argument for a family, id, size, name, pose or covariance that cannot be, and for a
  /// key or name that is there already.
  void add(MappedMarker marker);
  /// As add(), but a marker with the same key is replaced.
  void set(MappedMarker marker);
  /// @throws std::invalid_argument for a name that is there already.
  void addFrame(MappedFrame frame);

 private:
  void requireFreeName(const std::string& name) const;

  std::string frame_;
  std::map<MarkerKey, MappedMarker> markers_;
  std::vector<MappedFrame> frames_;
};

}  // namespace sextant
