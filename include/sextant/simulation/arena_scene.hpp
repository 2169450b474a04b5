// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/base/params.hpp"

namespace sextant {

/// An object in the arena: an upright pillar or a ball.
struct ArenaObject {
  /// A vertical cylinder or a sphere.
  enum class Shape { pillar, ball };
  Shape shape = Shape::pillar;        ///< pillar or ball
  Eigen::Vector3d position{0, 0, 0};  ///< foot of a pillar, centre of a ball, metres
  double radius = 0.05;               ///< metres, (0, 10]
  double height = 0.5;                ///< of a pillar, metres, (0, 10]
  Eigen::Vector3d colour{1, 1, 1};    ///< reflectance for red, green and blue, [0, 1]
};

/// Lighting of the arena.
struct ArenaLight {
  double brightness = 1.0;
  double direct = 0.5;
  Eigen::Vector3d toward{0.3, 0.5, 0.8};
  Eigen::Vector3d tint{1, 1, 1};

  ParamList fields();
};

/// Size and appearance of the arena.
struct ArenaSceneParams {
  Eigen::Vector2d size{8, 6};
  double wall_height = 2.5;
  int seed = 1;

  ParamList fields();
};

/// A room with a patterned floor and walls, and objects in it. Rays are intersected exactly with planes,
/// cylinders and spheres.
class ArenaScene {
 public:
  /// @throws std::invalid_argument as validate(ArenaSceneParams)
  explicit ArenaScene(const ArenaSceneParams& params);

  /// Replaces all objects.
  /// @throws std::invalid_argument for a radius, height or colour out of range
  void setObjects(const std::vector<ArenaObject>& objects);
  void setLight(const ArenaLight& light);  ///< @throws std::invalid_argument as validate(ArenaLight)

  /// Parameters given at construction.
  const ArenaSceneParams& params() const { return params_; }
  /// Objects given at construction.
  const std::vector<ArenaObject>& objects() const { return objects_; }

  /// A ray.
  struct Ray {
    Eigen::Vector3f origin;     ///< metres in the map
    Eigen::Vector3f direction;  ///< unit vector
  };
  /// First intersection of a ray.
  struct Hit {
    float distance = 0;  ///< metres
    int surface = 0;     ///< floor, walls and ceiling, then the objects
  };
  static constexpr int kBackgrounds = 6;  ///< number of surfaces of the room
  /// Intersects a ray with floor, walls and ceiling. @param ray starts in the room
  Hit background(const Ray& ray) const;
  /// Replaces the hit if the ray meets an object before it; returns whether it does.
  bool meets(const Ray& ray, int object, Hit* hit) const;
  /// Red, green and blue light from a hit. @param angle width of a pixel, radians
  Eigen::Vector3f light(const Ray& ray, const Hit& hit, float angle) const;

 private:
  struct Round {
    bool is_ball;
    Eigen::Vector3f position, colour;
    float radius, height;
  };
  static float toSide(const Ray& ray, const Round& round);  // metres
  static float toTop(const Ray& ray, const Round& round);   // of a cylinder
  Eigen::Vector3f normal(const Ray& ray, const Hit& hit) const;
  Eigen::Vector3f reflectance(const Eigen::Vector3f& point, const Hit& hit, float width) const;
  float shade(const Eigen::Vector3f& point, int surface) const;

  ArenaSceneParams params_;
  Eigen::Vector3f low_, high_;  // corners of the room
  std::array<std::vector<cv::Mat_<cv::Vec3f>>, kBackgrounds> textures_;
  std::vector<ArenaObject> objects_;
  std::vector<Round> rounds_;
  float ambient_ = 1, direct_ = 0;
  Eigen::Vector3f toward_{0, 0, 1}, tint_{1, 1, 1};
};

}  // namespace sextant
