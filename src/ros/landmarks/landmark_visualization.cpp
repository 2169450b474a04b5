// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/landmarks/landmark_visualization.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "sextant/ros/landmarks/landmark_conversions.hpp"
#include "sextant/ros/markers/marker_conversions.hpp"

namespace sextant {
namespace {

using Shape = visualization_msgs::Marker;

constexpr double kPillar = 0.12, kHeight = 0.4;  // metres: diameter and height
constexpr double kArrow = 0.4;                   // metres
constexpr double kText = 0.14;                   // metres
constexpr double kFlat = 0.004;                  // metres: height of an ellipse
constexpr double kDeviations = 2.0;
constexpr const char* kNames[] = {"pillars", "headings", "2 sigma", "names"};

std_msgs::ColorRGBA colour(float r, float g, float b, float a = 1.0f) {
  std_msgs::ColorRGBA result;
  result.r = r, result.g = g, result.b = b, result.a = a;
  return result;
}

/// Colour of full saturation. @param hue [0, 1)
std_msgs::ColorRGBA ofHue(double hue) {
  const auto channel = [&](double shift) {
    const double k = std::fmod(6 * hue + shift, 6.0);
    return static_cast<float>(0.9 - 0.7 * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
  };
  return colour(channel(5), channel(3), channel(1));
}

/// FNV-1a; std::hash may differ between machines.
uint32_t hashOf(const std::string& text) {
  uint32_t hash = 2166136261u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return hash;
}

Shape shape(const char* name, int type, int key, const Pose& T_map_shape, const std_msgs::ColorRGBA& colour) {
  Shape marker;
  marker.ns = name;
  marker.id = key;
  marker.type = type;
  marker.pose = toPoseMsg(T_map_shape);
  marker.color = colour;
  return marker;
}

void setScale(Shape& marker, double x, double y, double z) {
  marker.scale.x = x, marker.scale.y = y, marker.scale.z = z;
}

Shape ellipse(int key, const Eigen::Vector2d& position, const Eigen::Matrix2d& covariance,
              std_msgs::ColorRGBA colour) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  const Eigen::Vector2d width = 2 * kDeviations * axes.eigenvalues().cwiseMax(1e-8).cwiseSqrt();
  const Eigen::Vector2d first = axes.eigenvectors().col(0);
  colour.a = 0.5f;
  Shape marker =
      shape(kNames[2], Shape::CYLINDER, key, toPose({position, std::atan2(first.y(), first.x())}), colour);
  setScale(marker, width(0), width(1), kFlat);
  return marker;
}

void addShapes(const LandmarkSlam& slam, size_t which, std::vector<Shape>& all) {
  const Landmark2D& landmark = slam.filter().landmarks()[which];
  const LandmarkLabel& label = slam.labels()[which];
  const int key = slam.keys()[which];
  const std_msgs::ColorRGBA paint = colourOfClass(label.class_name);
  Pose at = toPose({landmark.position, landmark.heading.value_or(0)});
  at.translation().z() = kHeight / 2;
  all.push_back(shape(kNames[0], Shape::CYLINDER, key, at, paint));
  setScale(all.back(), kPillar, kPillar, kHeight);
  if (landmark.heading) {
    all.push_back(shape(kNames[1], Shape::ARROW, key, at, paint));
    setScale(all.back(), kArrow, kArrow / 8, kArrow / 8);
  }
  all.push_back(ellipse(key, landmark.position, slam.filter().covariance({which}).block<2, 2>(3, 3), paint));
  at.translation().z() = kHeight + kText;
  all.push_back(shape(kNames[3], Shape::TEXT_VIEW_FACING, key, at, colour(0.95f, 0.95f, 0.95f)));
  all.back().scale.z = kText;
  all.back().text = label.class_name + (label.id ? " " + std::to_string(*label.id) : "");
}

}  // namespace

std_msgs::ColorRGBA colourOfClass(const std::string& class_name) {
  static const std::pair<const char*, std_msgs::ColorRGBA> known[] = {
      {"blue", colour(0.15f, 0.4f, 0.95f)},   {"red", colour(0.85f, 0.15f, 0.15f)},
      {"green", colour(0.15f, 0.65f, 0.2f)},  {"yellow", colour(0.95f, 0.85f, 0.15f)},
      {"orange", colour(1.0f, 0.55f, 0.1f)},  {"purple", colour(0.6f, 0.25f, 0.75f)},
      {"white", colour(0.95f, 0.95f, 0.95f)}, {"black", colour(0.12f, 0.12f, 0.12f)}};
  for (const auto& [name, paint] : known)
    if (class_name.find(name) != std::string::npos) return paint;
  return ofHue(hashOf(class_name) * 2654435769u / 4294967296.0);  // Fibonacci hashing: far apart
}

visualization_msgs::MarkerArray LandmarkVisualization::update(const LandmarkSlam& slam,
                                                              const std::string& frame,
                                                              const ros::Time& stamp) {
  visualization_msgs::MarkerArray array;
  const std::set<int> known(slam.keys().begin(), slam.keys().end());
  for (const int key : shown_) {
    if (known.count(key) > 0) continue;
    for (const char* name : kNames) {
      array.markers.push_back(shape(name, Shape::CYLINDER, key, Pose::Identity(), {}));
      array.markers.back().action = Shape::DELETE;
    }
  }
  for (size_t i = 0; i < slam.labels().size(); ++i) addShapes(slam, i, array.markers);
  for (Shape& marker : array.markers) marker.header.frame_id = frame, marker.header.stamp = stamp;
  shown_ = known;
  return array;
}

}  // namespace sextant
