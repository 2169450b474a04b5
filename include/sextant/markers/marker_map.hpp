// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sextant/geometry/pose.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// A marker with a known pose.
struct MappedMarker {
  MarkerKey key;                           ///< family and id
  double size = 0.0;                       ///< edge length, metres
  std::string name;                        ///< tf frame
  Pose T_map_marker = Pose::Identity();    ///< pose of the marker in the map
  Matrix6d covariance = Matrix6d::Zero();  ///< position, rotation in the map's axes (m^2, rad^2); zero: exact
};

/// A frame of a map file that is not a marker, e.g. a camera mount.
struct MappedFrame {
  std::string name;                        ///< tf frame
  std::string parent;                      ///< tf frame
  Pose T_parent_frame = Pose::Identity();  ///< pose of the frame in its parent
};

/// A map of printed markers: poses by family and id, all in one frame.
class MarkerMap {
 public:
  /// An empty map. @param frame tf frame of the map
  explicit MarkerMap(std::string frame = "map") : frame_(std::move(frame)) {}

  const std::string& frame() const { return frame_; }  ///< tf frame of the map
  /// All markers, ordered by family and id.
  const std::map<MarkerKey, MappedMarker>& markers() const { return markers_; }
  const std::vector<MappedFrame>& frames() const { return frames_; }  ///< other frames of the map file

  /// Returns the marker, or nullptr if the map does not contain it.
  const MappedMarker* find(const MarkerKey& key) const;

  /// Adds a marker; an empty name becomes "<family>/<id>".
  /// @throws std::invalid_argument for an invalid family, id, size, name, pose or covariance, and for a key
  /// or name that the map already contains
  void add(MappedMarker marker);
  /// As add(), but replaces a marker with the same key.
  void set(MappedMarker marker);
  /// Adds another frame.
  /// @throws std::invalid_argument for an invalid pose or parent, or a name that the map already contains
  void addFrame(MappedFrame frame);

 private:
  void requireFreeName(const std::string& name) const;

  std::string frame_;
  std::map<MarkerKey, MappedMarker> markers_;
  std::vector<MappedFrame> frames_;
};

}  // namespace sextant
