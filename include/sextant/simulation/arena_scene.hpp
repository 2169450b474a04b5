// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/base/params.hpp"

namespace sextant {

/// An object in the arena: an upright pillar, a ball or an upright box.
struct ArenaObject {
  /// A vertical cylinder, a sphere or a cuboid.
  enum class Shape { pillar, ball, box };
  Shape shape = Shape::pillar;        ///< pillar, ball or box
  Eigen::Vector3d position{0, 0, 0};  ///< foot of a pillar, centre of a ball or of a box's bottom, metres
  double radius = 0.05;               ///< of a pillar or ball, metres, (0, 10]
  double height = 0.5;                ///< of a pillar or box, metres, (0, 10]
  Eigen::Vector2d sides{0.1, 0.1};    ///< of a box, metres, (0, 10]
  double yaw = 0;                     ///< from the map's x axis to a box's first side, radians
  Eigen::Vector3d colour{1, 1, 1};    ///< reflectance for red, green and blue, [0, 1]
  double dirt = 0;                    ///< fraction of the light lost in the darkest smudges, [0, 1]

  /// Distance of its farthest point from its vertical axis, metres.
  double reach() const { return shape == Shape::box ? 0.5 * sides.norm() : radius; }
};

/// Lighting of the arena.
struct ArenaLight {
  double brightness = 1.0;
  double direct = 0.5;
  double shadows = 0;
  Eigen::Vector3d toward{0.3, 0.5, 0.8};
  Eigen::Vector3d tint{1, 1, 1};

  ParamList fields();
};

/// Size and appearance of the arena.
struct ArenaSceneParams {
  Eigen::Vector2d size{8, 6};
  double wall_height = 2.5;
  double gloss = 0;
  int seed = 1;

  ParamList fields();
};

/// A room with a patterned floor and walls, and objects in it. Rays are intersected exactly with planes,
/// cylinders, spheres and boxes.
class ArenaScene {
 public:
  /// @throws std::invalid_argument as validate(ArenaSceneParams)
  explicit ArenaScene(const ArenaSceneParams& params);

  /// Replaces all objects.
  /// @throws std::invalid_argument for a size, colour or dirt out of range
  void setObjects(const std::vector<ArenaObject>& objects);
  void setLight(const ArenaLight& light);  ///< @throws std::invalid_argument as validate(ArenaLight)
  /// Covers a surface of the room with copies of a photo, of reflectance (level / 255)^2.2.
  /// @param surface as Hit::surface, below kBackgrounds
  /// @param photo 8-bit RGB
  /// @param width of a copy, metres, [0.1, 20]
  /// @throws std::invalid_argument for another surface, an empty photo or a width out of range
  void setTexture(int surface, const cv::Mat& photo, double width);

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
    int surface = 0;  ///< floor, left, right, front and back wall (-x, x, -y, y), ceiling, then the objects
  };
  static constexpr int kBackgrounds = 6;  ///< number of surfaces of the room
  /// Intersects a ray with floor, walls and ceiling. @param ray starts in the room
  Hit background(const Ray& ray) const;
  /// Replaces the hit if the ray meets an object before it; returns whether it does.
  bool meets(const Ray& ray, int object, Hit* hit) const;
  /// Intersects the ray with the room and all objects. @param ray starts in the room
  Hit first(const Ray& ray) const;
  /// Red, green and blue light from a hit. @param angle width of a pixel, radians
  Eigen::Vector3f light(const Ray& ray, const Hit& hit, float angle) const;

 private:
  struct Solid {
    ArenaObject::Shape shape;
    Eigen::Vector3f position, colour;
    float radius, height, dirt;
    Eigen::Vector2f half;  // sides of a box
    Eigen::Rotation2Df turn;
  };
  static float toRound(const Ray& ray, const Solid& round);  // metres, to the side of a pillar or to a ball
  static float toTop(const Ray& ray, const Solid& pillar);
  static float toBox(const Ray& ray, const Solid& box);
  static Eigen::Vector3f boxNormal(const Eigen::Vector3f& from_foot, const Solid& box);
  Eigen::Vector3f normal(const Ray& ray, const Hit& hit) const;
  Eigen::Vector3f reflectance(const Eigen::Vector3f& point, const Hit& hit, float width) const;
  Eigen::Vector3f scattered(const Ray& ray, const Hit& hit, float angle) const;  // light without reflections
  float lit(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;
  float shade(const Eigen::Vector3f& point, int surface) const;

  ArenaSceneParams params_;
  Eigen::Vector3f low_, high_;  // corners of the room
  std::array<std::vector<cv::Mat_<cv::Vec3f>>, kBackgrounds> textures_;
  std::vector<cv::Mat_<cv::Vec3f>> smudges_;
  std::vector<ArenaObject> objects_;
  std::vector<Solid> solids_;
  float ambient_ = 1, direct_ = 0, shadows_ = 0;
  Eigen::Vector3f toward_{0, 0, 1}, tint_{1, 1, 1};
};

}  // namespace sextant
