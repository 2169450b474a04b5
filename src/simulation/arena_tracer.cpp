// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arena_tracer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sextant {
namespace {

using Eigen::Vector3f;

constexpr double kNear = 0.02;  // metres; distance of the near plane
constexpr int kMargin = 2;      // pixels around an object's box

}  // namespace

ArenaTracer::ArenaTracer(const CameraModel& camera)
    : camera_(camera),
      width_(camera.width()),
      height_(camera.height()),
      pixel_angle_(static_cast<float>(1 / camera.focalLength())),
      distances_(camera.height(), camera.width()),
      surfaces_(camera.height(), camera.width()) {
  for (int y = 0; y <= height_; ++y)
    for (int x = 0; x <= width_; ++x)
      rays_.push_back(camera.unproject({x, y}).value_or(Eigen::Vector3d::Zero()).cast<float>());
}

ArenaScene::Ray ArenaTracer::ray(int x, int y, const Eigen::Vector2f& off) const {
  const Vector3f& here = rayAt(x, y);
  Vector3f direction = here;
  // Interpolate between the rays of neighbouring pixels.
  if (off.x() != 0 || off.y() != 0)
    direction = (here + off.x() * (rayAt(x + 1, y) - here) + off.y() * (rayAt(x, y + 1) - here)).normalized();
  return {origin_, R_map_camera_ * direction};
}

void ArenaTracer::trace(const ArenaScene& scene, const Pose& T_map_camera) {
  const Eigen::Vector3d at = T_map_camera.translation();
  const Eigen::Vector2d half = 0.5 * scene.params().size;
  if ((at.head<2>().cwiseAbs().array() >= half.array()).any() || at.z() <= 0 ||
      at.z() >= scene.params().wall_height)
    throw std::invalid_argument("the camera is outside the arena");
  R_map_camera_ = T_map_camera.linear().cast<float>();
  origin_ = at.cast<float>();
  traceBackground(scene);
  const Pose T_camera_map = T_map_camera.inverse();
  for (size_t object = 0; object < scene.objects().size(); ++object)
    traceObject(scene, static_cast<int>(object), boxOf(scene.objects()[object], T_camera_map));
}

void ArenaTracer::traceBackground(const ArenaScene& scene) {
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const bool has_ray = rayAt(x, y).z() > 0;
      const ArenaScene::Hit hit = has_ray ? scene.background(ray(x, y)) : ArenaScene::Hit{};
      distances_(y, x) = hit.distance;
      surfaces_(y, x) = has_ray ? static_cast<std::uint16_t>(hit.surface) : kNothing;
    }
}

void ArenaTracer::traceObject(const ArenaScene& scene, int object, const cv::Rect& box) {
  for (int y = box.y; y < box.y + box.height; ++y)
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (surfaces_(y, x) == kNothing) continue;
      ArenaScene::Hit hit{distances_(y, x), surfaces_(y, x)};
      if (!scene.meets(ray(x, y), object, &hit)) continue;
      distances_(y, x) = hit.distance;
      surfaces_(y, x) = static_cast<std::uint16_t>(hit.surface);
    }
}

/// Bounding box of an object in the image, pixels.
cv::Rect ArenaTracer::boxOf(const ArenaObject& object, const Pose& T_camera_map) const {
  const bool is_ball = object.shape == ArenaObject::Shape::ball;
  const double r = object.reach();
  Eigen::AlignedBox2d box;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d off(corner & 1 ? r : -r, corner & 2 ? r : -r,
                              corner & 4 ? (is_ball ? r : object.height) : (is_ball ? -r : 0));
    const Eigen::Vector3d point = T_camera_map * (object.position + off);
    const auto pixel = camera_.project(point);
    if (point.z() < kNear || !pixel) return {0, 0, point.z() < -4 * r - object.height ? 0 : width_, height_};
    box.extend(*pixel);
  }
  const cv::Point low(static_cast<int>(std::floor(std::max(-1e6, box.min().x()))) - kMargin,
                      static_cast<int>(std::floor(std::max(-1e6, box.min().y()))) - kMargin);
  const cv::Point high(static_cast<int>(std::ceil(std::min(1e6, box.max().x()))) + kMargin,
                       static_cast<int>(std::ceil(std::min(1e6, box.max().y()))) + kMargin);
  return cv::Rect(low, high) & cv::Rect(0, 0, width_, height_);
}

}  // namespace sextant
