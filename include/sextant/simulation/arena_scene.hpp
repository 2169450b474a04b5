// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/base/params.hpp"

namespace sextant {

/// A round thing: a pillar stands on the floor, upright; a ball lies anywhere.
struct ArenaObject {
  enum class Shape { pillar, ball };
  Shape shape = Shape::pillar;
  Eigen::Vector3d position{0, 0, 0};  ///< of a pillar's foot, of a ball's centre, metres
  double radius = 0.05;               ///< metres, (0, 10]
  double height = 0.5;                ///< of a pillar, metres, (0, 10]
  Eigen::Vector3d colour{1, 1, 1};    ///< share of red, green and blue light that is reflected, [0, 1]
};

/// The light of the moment.
struct ArenaLight {
  double brightness = 1.0;
  double direct = 0.5;
  Eigen::Vector3d toward{0.3, 0.5, 0.8};
  Eigen::Vector3d tint{1, 1, 1};

  ParamList fields();
};

struct ArenaSceneParams {
  Eigen::Vector2d size{8, 6};
  double wall_height = 2.5;
  int seed = 1;

  ParamList fields();
};

/// A room with a patterned floor and walls, and what stands and lies in it. Rays meet planes, cylinders and
/// spheres exactly.
class ArenaScene {
 public:
  /// @throws std::invalid_argument as validate(ArenaSceneParams)
  explicit ArenaScene(const ArenaSceneParams& params);

  /// @throws std::invalid_argument for a radius, height or colour out of range
  void setObjects(const std::vector<ArenaObject>& objects);
  void setLight(const ArenaLight& light);  ///< @throws std::invalid_argument as validate(ArenaLight)

  const ArenaSceneParams& params() const { return params_; }
  const std::vector<ArenaObject>& objects() const { return objects_; }

  struct Ray {
    Eigen::Vector3f origin, direction;  // metres in the map, unit
  };
  /// Where a ray ends. Surfaces: floor, walls and ceiling, then the objects.
  struct Hit {
    float distance = 0;
    int surface = 0;
  };
  static constexpr int kBackgrounds = 6;

  /// Of floor, walls and ceiling. @param ray begins in the room
  Hit background(const Ray& ray) const;
  /// Whether a ray meets an object before a hit, which becomes that one.
  bool meets(const Ray& ray, int object, Hit* hit) const;
  /// @param angle that a pixel is wide, radians @returns light of red, green and blue
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
