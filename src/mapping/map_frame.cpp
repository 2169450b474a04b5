// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_frame.hpp"

#include <cmath>
#include <map>
#include <stdexcept>

#include "sextant/mapping/map_growth.hpp"

namespace sextant {
namespace {

constexpr double kQuarterTurn = 1.5707963267948966;
constexpr double kHeld = 1e-6;  // metres or radians
constexpr double kFree = 10.0;

// Groups of markers connected by images or by the odometry of a drive (union-find).
class Islands {
 public:
  // Connects the markers of an instant with each other, and with those of its drive if there is odometry.
  void connect(const RecordedInstant& instant, const std::set<MarkerKey>& markers) {
    const MarkerKey* last = nullptr;
    for (const MarkerKey& key : markers) last = joined(last, key);
    if (last && instant.T_odom_base) {
      const auto drive = drives_.emplace(instant.drive, *last).first;
      joined(&drive->second, *last);
    }
  }

  std::set<MarkerKey> connectedWith(const MarkerMap& map) const {
    std::set<MarkerKey> roots, found;
    for (const auto& entry : map.markers())
      if (parents_.count(entry.first) != 0) roots.insert(root(entry.first));
    for (const auto& entry : parents_)
      if (roots.count(root(entry.first)) != 0) found.insert(entry.first);
    return found;
  }

  MarkerKey firstOfLargest() {
    std::map<MarkerKey, int> sizes;
    for (const auto& entry : parents_) ++sizes[root(entry.first)];
    const MarkerKey* best = nullptr;
    for (const auto& entry : parents_)
      if (!best || sizes[root(entry.first)] > sizes[root(*best)]) best = &entry.first;
    if (!best) throw std::runtime_error("no marker was seen");
    return *best;
  }

 private:
  MarkerKey root(MarkerKey key) const {
    while (!(parents_.at(key) == key)) key = parents_.at(key);
    return key;
  }

  const MarkerKey* joined(const MarkerKey* a, const MarkerKey& b) {
    const auto place = parents_.emplace(b, b).first;
    if (a) parents_[root(*a)] = root(b);
    return &place->first;
  }

  std::map<MarkerKey, MarkerKey> parents_;
  std::map<int, MarkerKey> drives_;
};

}  // namespace

MarkerMap firstMarker(const std::string& frame, const MarkerRecording& recording, const MarkerSizes& sizes,
                      const std::set<MarkerKey>& without) {
  Islands islands;
  for (const RecordedInstant& instant : recording) {
    std::set<MarkerKey> markers;
    for (const MarkerView& view : instant.views)
      for (const Detection& detection : view.detections)
        if (without.count(detection.key) == 0) markers.insert(detection.key);
    islands.connect(instant, markers);
  }
  const MarkerKey key = islands.firstOfLargest();
  MarkerMap map(frame);
  map.add({key, sizes.of(key), "", poseFromXyzRpy({0, 0, 0}, {kQuarterTurn, 0, 0}), Matrix6d::Zero()});
  return map;
}

std::set<MarkerKey> connectedMarkers(const MarkerRecording& recording,
                                     const std::vector<RecordedObservation>& observations,
                                     const MarkerMap& map) {
  std::map<size_t, std::set<MarkerKey>> instants;
  for (const RecordedObservation& each : observations)
    instants[each.instant].insert(detectionOf(recording, each).key);
  Islands islands;
  for (const auto& [instant, markers] : instants) islands.connect(recording[instant], markers);
  return islands.connectedWith(map);
}

MarkerMap putOnFloor(const MarkerKey& first, MapEstimate& estimate) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  double height = 0;
  int count = 0;
  for (const auto& pose : estimate.T_map_base) {
    if (!pose) continue;
    up += pose->linear().col(2);
    ++count;
  }
  const Eigen::Quaterniond level = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ());
  for (const auto& pose : estimate.T_map_base)
    if (pose) height += (level * pose->translation()).z() / count;
  const Eigen::Vector3d looks = level * estimate.map.find(first)->T_map_marker.linear().col(2);
  const double yaw = -kQuarterTurn - std::atan2(looks.y(), looks.x());
  Pose T_new_old = Pose::Identity();
  T_new_old.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * level.toRotationMatrix();
  T_new_old.translation() = Eigen::Vector3d(0, 0, -height);
  MarkerMap map(estimate.map.frame()), held(estimate.map.frame());
  for (const auto& entry : estimate.map.markers()) {
    MappedMarker marker = entry.second;
    marker.T_map_marker = T_new_old * marker.T_map_marker;
    map.add(marker);
  }
  for (auto& pose : estimate.T_map_base)
    if (pose) pose = T_new_old * *pose;
  estimate.map = map;
  MappedMarker marker = *map.find(first);
  Vector6d sigmas;
  sigmas << kHeld, kHeld, kFree, kFree, kFree, kHeld;
  marker.covariance = sigmas.cwiseAbs2().asDiagonal();
  held.add(marker);
  return held;
}

}  // namespace sextant
