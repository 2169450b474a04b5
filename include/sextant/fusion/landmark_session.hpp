// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sextant/fusion/landmark_slam_node_params.hpp"
#include "sextant/landmarks/landmark_map_file.hpp"
#include "sextant/landmarks/landmark_timeline.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Landmark SLAM with map files, as the nodelet runs it.
class LandmarkSession {
 public:
  /// Reads the map files of the parameters. @throws std::exception with the file and the reason
  explicit LandmarkSession(const LandmarkSlamNodeParams& params);

  const LandmarkSlam& slam() const { return timeline_->slam(); }  ///< state after the newest scan
  LandmarkTimeline& timeline() { return *timeline_; }             ///< takes odometry and scans
  const std::string& frame() const { return frame_; }             ///< frame_id of the map
  LandmarkMap map() const;                                        ///< current map, as save() writes it
  /// The marker map; nullptr if there is none.
  const MarkerMap* markerMap() const { return markers_ ? &*markers_ : nullptr; }

  /// Reason why the map is empty although the parameters need one; empty text: it is not, or not needed.
  std::string emptyMapReason() const;

  /// Restarts odometry and keeps the map; the robot is lost.
  void restart();
  /// Discards the map, but not the marker map.
  void reset();
  /// Discards the pose: the robot is lost until it is found in the map.
  /// @throws std::runtime_error if the map is empty, and there are no places
  void relocalize();
  /// Sets the pose of the robot at the newest odometry; it is not lost then.
  void setPose(const PoseEstimate2D& estimate);
  /// Replaces the landmarks by those of a marker map; only adds those that it does not contain to a map that
  /// was read from a file. @throws std::invalid_argument if the frames of both differ
  void setMarkerMap(const MarkerMap& map);
  /// Writes or reads a map file. @param file empty: map_file @returns the absolute path
  /// @throws std::exception with the reason; nothing is changed then @{
  std::string save(const std::string& file) const;
  std::string load(const std::string& file);
  /// @}

 private:
  PoseEstimate2D start() const { return {params_.startPose(), params_.startCovariance()}; }
  std::string pathOf(const std::string& file) const;
  void load(const std::string& path, const std::string& start);
  static LandmarkMap withMarkers(LandmarkMap map, const MarkerMap& marker_map);
  static void set(LandmarkSlam& slam, const LandmarkMap& map, bool is_lost);
  bool hasOnlyPlaces() const;
  void applyMarkerMap(const PoseEstimate2D& robot, bool lost);

  LandmarkSlamNodeParams params_;
  std::unique_ptr<LandmarkTimeline> timeline_;
  std::optional<MarkerMap> markers_;
  bool is_from_file_ = false;  // whether the map was read from a landmark map file
  std::string frame_;
};

}  // namespace sextant
