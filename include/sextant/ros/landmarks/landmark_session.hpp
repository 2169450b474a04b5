// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sextant/fusion/landmark_slam_node_params.hpp"
#include "sextant/landmarks/landmark_timeline.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// SLAM as the nodelet runs it: with the maps that it begins with, reads and writes.
class LandmarkSession {
 public:
  /// Reads the files that the parameters name. @throws std::exception with the file and the reason
  explicit LandmarkSession(const LandmarkSlamNodeParams& params);

  const LandmarkSlam& slam() const { return timeline_->slam(); }
  LandmarkTimeline& timeline() { return *timeline_; }
  const std::string& frame() const { return frame_; }  ///< of the map

  /// Where a map was asked for that is not there; empty: there is one, or markers may still come.
  std::string whyEmpty() const;

  /// Odometry begins anew, the map stays, and the robot may be anywhere in it.
  void restart();
  /// All that was learnt is forgotten; the markers whose places are known are not.
  void reset();
  /// @throws std::runtime_error where there is nothing to find the robot by
  void relocalize();
  void setPose(const PlanePoseEstimate& told);
  /// Where printed markers hang: landmarks that were there before are forgotten, but those that a map file
  /// had, which may be of the same markers. @returns whether it is used
  bool takeMarkers(const MarkerMap& map);
  /// @param file empty: map_file @returns the absolute path @throws std::exception with the reason; nothing
  /// has changed then @{
  std::string save(const std::string& file) const;
  std::string load(const std::string& file);
  /// @}

 private:
  PlanePoseEstimate start() const { return {params_.startPose(), params_.startCovariance()}; }
  std::string pathOf(const std::string& file) const;
  void load(const std::string& path, const std::string& start);
  void setMarkers(const PlanePoseEstimate& robot, bool lost);

  LandmarkSlamNodeParams params_;
  std::unique_ptr<LandmarkTimeline> timeline_;
  std::optional<MarkerMap> markers_;
  bool is_from_file_ = false;  // the map
  std::string frame_;
};

}  // namespace sextant
