// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/localization/locator_visualization.hpp"

namespace sextant {
namespace {

constexpr size_t kTrail = 2000;       // positions
constexpr double kTrailStep = 0.02;   // metres between positions
constexpr double kLineWidth = 0.015;  // metres

geometry_msgs::Point toPoint(const Eigen::Vector3d& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

visualization_msgs::Marker lines(const std::string& name, int type, const std::string& frame,
                                 const ros::Time& stamp) {
  visualization_msgs::Marker marker;
  marker.header.frame_id = frame;
  marker.header.stamp = stamp;
  marker.ns = name;
  marker.type = type;
  marker.pose.orientation.w = 1;
  marker.scale.x = kLineWidth;
  marker.color.r = 1.0f;
  marker.color.g = 0.6f;
  marker.color.a = 0.9f;
  return marker;
}

}  // namespace

visualization_msgs::MarkerArray LocatorVisualization::update(const LocatedPose& pose,
                                                             const Pose& T_map_camera, const MarkerMap& map,
                                                             const ros::Time& stamp) {
  using visualization_msgs::Marker;
  Marker sight = lines("lines of sight", Marker::LINE_LIST, map.frame(), stamp);
  for (const MarkerKey& key : pose.used()) {
    const MappedMarker* mapped = map.find(key);
    if (!mapped) continue;
    sight.points.push_back(toPoint(T_map_camera.translation()));
    sight.points.push_back(toPoint(mapped->T_map_marker.translation()));
  }
  const geometry_msgs::Point here = toPoint(pose.T_map_base.translation());
  const auto far = [&](const geometry_msgs::Point& p) {
    return std::hypot(p.x - here.x, p.y - here.y, p.z - here.z) >= kTrailStep;
  };
  if (trail_.empty() || far(trail_.back())) trail_.push_back(here);
  if (trail_.size() > kTrail) trail_.pop_front();
  Marker trail = lines("trail", Marker::LINE_STRIP, map.frame(), stamp);
  trail.color.r = 0.1f;
  trail.color.g = 0.7f;
  trail.color.b = 1.0f;
  trail.points.assign(trail_.begin(), trail_.end());
  if (trail.points.size() < 2) trail.action = Marker::DELETE;
  visualization_msgs::MarkerArray array;
  array.markers = {sight, trail};
  return array;
}

}  // namespace sextant
