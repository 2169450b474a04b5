// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/fusion/landmark_session.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "sextant/fusion/marker_landmarks.hpp"
#include "sextant/markers/marker_map_file.hpp"

namespace sextant {
LandmarkSession::LandmarkSession(const LandmarkSlamNodeParams& params) : params_(params) {
  if (!params_.marker_map_file.empty()) markers_ = readMarkerMap(params_.marker_map_file, {});
  reset();
  if (!params_.map_file.empty() && std::filesystem::exists(params_.map_file))
    load(params_.map_file, params_.start);
}

std::string LandmarkSession::emptyMapReason() const {
  const bool is_needed = params_.slam.read_only || params_.start != "origin";
  if (!is_needed || !slam().labels().empty() || !params_.cameras.empty() || hasOnlyPlaces()) return "";
  const std::string needed_by =
      params_.slam.read_only ? "read_only is true" : "start is '" + params_.start + "'";
  const std::string why =
      params_.map_file.empty() ? "~map_file is not set" : params_.map_file + " does not exist or is empty";
  return needed_by + ", but " + why + ": the map is empty, and the robot is at ~start_pose";
}

bool LandmarkSession::hasOnlyPlaces() const {
  return !params_.places.empty() && params_.start == "unknown" && slam().labels().empty();
}

// ---- pose and marker map

void LandmarkSession::restart() {
  timeline_->restart();
  timeline_->change([&](LandmarkSlam& slam) {
    slam.labels().empty() ? slam.setPose(start().pose, start().covariance) : slam.relocalize();
    if (hasOnlyPlaces()) slam.lose();
  });
}

void LandmarkSession::reset() {
  timeline_ = std::make_unique<LandmarkTimeline>(
      params_.timeline, LandmarkSlam(params_.slam, start().pose, start().covariance));
  frame_ = params_.map_frame;
  is_from_file_ = false;
  if (markers_) applyMarkerMap(start(), params_.start_pose.empty());
  if (hasOnlyPlaces()) timeline_->change([](LandmarkSlam& slam) { slam.lose(); });
}

void LandmarkSession::relocalize() {
  if (slam().labels().empty() && params_.places.empty())
    throw std::runtime_error("the map has no landmarks yet to localize the robot with");
  timeline_->change([](LandmarkSlam& slam) { slam.lose(); });
}

void LandmarkSession::setPose(const PoseEstimate2D& estimate) {
  timeline_->change([&](LandmarkSlam& slam) { slam.setPose(estimate.pose, estimate.covariance); });
}

void LandmarkSession::setMarkerMap(const MarkerMap& map) {
  const bool is_first = !markers_;
  if (is_from_file_) {
    const LandmarkMap all = withMarkers(this->map(), map);
    timeline_->change([&](LandmarkSlam& slam) { set(slam, all, all.is_lost); });
  }
  markers_ = map;
  if (is_from_file_) return;
  const LandmarkFilter& filter = slam().filter();
  is_first ? reset() : applyMarkerMap({filter.pose(), filter.covariance({})}, slam().isLost());
}

/// Adds the markers of the marker map that are not in a landmark map.
LandmarkMap LandmarkSession::withMarkers(LandmarkMap map, const MarkerMap& marker_map) {
  if (marker_map.frame() != map.frame)
    throw std::invalid_argument("the frame of the marker map is '" + marker_map.frame() +
                                "', that of the landmark map '" + map.frame + "': they must be equal");
  const MarkerLandmarks markers = landmarksOf(marker_map);
  for (size_t i = 0; i < markers.landmarks.size(); ++i) {
    if (std::find(map.labels.begin(), map.labels.end(), markers.labels[i]) != map.labels.end()) continue;
    map.landmarks.push_back(markers.landmarks[i]);
    map.labels.push_back(markers.labels[i]);
    const Eigen::Index size = map.covariance.rows();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size + 3, size + 3);
    covariance.topLeftCorner(size, size) = map.covariance;
    covariance.bottomRightCorner<3, 3>() = markers.covariances[i];
    map.covariance = covariance;
  }
  return map;
}

void LandmarkSession::set(LandmarkSlam& slam, const LandmarkMap& map, bool is_lost) {
  slam.setMap(map.T_map_base, map.landmarks, map.labels, map.covariance);
  if (is_lost) slam.relocalize();
}

/// The markers are uncorrelated: a marker map has no cross covariances.
void LandmarkSession::applyMarkerMap(const PoseEstimate2D& robot, bool lost) {
  const MarkerLandmarks markers = landmarksOf(*markers_);
  const auto count = static_cast<Eigen::Index>(markers.landmarks.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(3 + 3 * count, 3 + 3 * count);
  covariance.topLeftCorner<3, 3>() = robot.covariance;
  for (Eigen::Index i = 0; i < count; ++i)
    covariance.block<3, 3>(3 + 3 * i, 3 + 3 * i) = markers.covariances[static_cast<size_t>(i)];
  timeline_->change([&](LandmarkSlam& slam) {
    slam.setMap(robot.pose, markers.landmarks, markers.labels, covariance);
    if (lost) slam.relocalize();
  });
  frame_ = markers_->frame();
}

// ---- files

std::string LandmarkSession::pathOf(const std::string& file) const {
  const std::string& path = file.empty() ? params_.map_file : file;
  if (path.empty()) throw std::invalid_argument("specify a file, or set ~map_file");
  return std::filesystem::absolute(path);
}

LandmarkMap LandmarkSession::map() const {
  const LandmarkFilter& filter = slam().filter();
  return {frame_, filter.pose(), filter.landmarks(), slam().labels(), filter.covariance(), slam().isLost()};
}

std::string LandmarkSession::save(const std::string& file) const {
  const std::string path = pathOf(file);
  writeLandmarkMap(map(), path);
  return path;
}

std::string LandmarkSession::load(const std::string& file) {
  const std::string path = pathOf(file);
  load(path, params_.start == "map" ? "map" : "unknown");  // the robot is no longer at the origin
  return path;
}

void LandmarkSession::load(const std::string& path, const std::string& start) {
  LandmarkMap map = readLandmarkMap(path);
  if (markers_) map = withMarkers(map, *markers_);
  timeline_->change([&](LandmarkSlam& slam) {
    set(slam, map, start == "unknown" || (start == "map" && map.is_lost));
    if (start == "origin") slam.setPose(params_.startPose(), params_.startCovariance());
  });
  frame_ = map.frame;
  is_from_file_ = true;
}

}  // namespace sextant
