// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sextant/simulation/arena_scene.hpp"
#include "test_cameras.hpp"

namespace sextant {

inline constexpr double kFocal = 400, kCx = 319.5, kCy = 239.5;

inline CameraModel pinhole(double focal_length = kFocal, const std::vector<double>& D = {}) {
  CameraCalibration c = testCalibration("plumb_bob", D);
  c.K << focal_length, 0, kCx, 0, focal_length, kCy, 0, 0, 1;
  return CameraModel(c, CameraModel::Image::raw);
}

// 10 m wide, long and high: from the middle a wall fills the image.
inline ArenaScene hall(const std::vector<ArenaObject>& objects = {}) {
  ArenaSceneParams params;
  params.size = {10, 10};
  params.wall_height = 10;
  ArenaScene scene(params);
  scene.setObjects(objects);
  return scene;
}

inline ArenaObject object(ArenaObject::Shape shape, const Eigen::Vector3d& position, double radius,
                          double height) {
  ArenaObject object;
  object.shape = shape;
  object.position = position;
  object.radius = radius;
  object.height = height;
  return object;
}
inline ArenaObject pillar(double x, double y, double radius = 0.1, double height = 0.5) {
  return object(ArenaObject::Shape::pillar, {x, y, 0}, radius, height);
}
inline ArenaObject ball(double x, double y, double z, double radius = 0.1) {
  return object(ArenaObject::Shape::ball, {x, y, z}, radius, 1);
}

inline Pose levelAt(double x, double z) { return cameraPose({x, 0, z}, {0, 0, 0}); }

}  // namespace sextant
