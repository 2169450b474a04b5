// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/arena_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "arena_noise.hpp"
#include "arena_texture.hpp"
#include "sextant/base/range.hpp"

namespace sextant {
namespace {

using Eigen::Vector3f;

enum Background { kFloor, kLeft, kRight, kFront, kBack, kCeiling };
constexpr float kNever = std::numeric_limits<float>::max();
constexpr float kAlmost = 1e-4F;       // metres; tolerance of a point
constexpr float kContact = 0.35F;      // fraction of the light that is lost where an object touches the floor
constexpr float kContactReach = 1.5F;  // radius of this shadow in radii of the object

void requireColour(const std::string& name, const Eigen::Vector3d& colour, double most) {
  for (int i = 0; i < 3; ++i) Range::closed(0, most).require(name, colour[i]);
}

}  // namespace

ParamList ArenaLight::fields() {
  const auto require_length = [this](const Param& param) {
    Range::openLow(0, 1e9).require(param.name + "'s length", toward.norm());
  };
  return {
      {"brightness", &brightness, Range::closed(0, 10), "",
       "brightness of the light; 1: white objects appear white"},
      {"direct", &direct, Range::closed(0, 1), "", "fraction of directional light"},
      {"toward", Numbers{toward.data(), 3}, Allowed("longer than 0", require_length), "",
       "direction toward the directional light"},
      {"tint", Numbers{tint.data(), 3}, Range::closed(0, 10), "", "red, green and blue of the light"},
  };
}

ParamList ArenaSceneParams::fields() {
  return {
      {"size", Numbers{size.data(), 2}, Range::closed(1, 100), "m",
       "size of the floor; its centre is the origin"},
      {"wall_height", &wall_height, Range::closed(0.1, 100), "m", "height of the walls"},
      {"seed", &seed, Range::closed(0, std::numeric_limits<int>::max()), "",
       "seed of the textures of floor, walls and ceiling"},
  };
}

ArenaScene::ArenaScene(const ArenaSceneParams& params) : params_(params) {
  validate(params);
  const Eigen::Vector2f half = 0.5F * params.size.cast<float>();
  low_ << -half, 0;
  high_ << half, static_cast<float>(params.wall_height);
  cv::RNG random = arenaRandom(static_cast<std::uint64_t>(params.seed));
  textures_[kFloor] = arenaPyramid(arenaFloor(params.size.x(), params.size.y(), random));
  for (const int wall : {kLeft, kRight, kFront, kBack})
    textures_[wall] = arenaPyramid(
        arenaWall(wall < kFront ? params.size.y() : params.size.x(), params.wall_height, random));
  textures_[kCeiling] = arenaPyramid(arenaCeiling(params.size.x(), params.size.y(), random));
}

void ArenaScene::setObjects(const std::vector<ArenaObject>& objects) {
  std::vector<Round> rounds;
  for (const ArenaObject& each : objects) {
    Range::openLow(0, 10).require("radius", each.radius, "m");
    Range::openLow(0, 10).require("height", each.height, "m");
    requireColour("colour", each.colour, 1);
    rounds.push_back({each.shape == ArenaObject::Shape::ball, each.position.cast<float>(),
                      each.colour.cast<float>(), static_cast<float>(each.radius),
                      static_cast<float>(each.height)});
  }
  objects_ = objects;
  rounds_ = rounds;
}

void ArenaScene::setLight(const ArenaLight& light) {
  validate(light);
  tint_ = (light.brightness * light.tint).cast<float>();
  direct_ = static_cast<float>(light.direct);
  ambient_ = 1 - direct_;
  toward_ = light.toward.normalized().cast<float>();
}

ArenaScene::Hit ArenaScene::background(const Ray& ray) const {
  Hit hit{kNever, kFloor};
  constexpr int kFaces[3][2] = {{kLeft, kRight}, {kFront, kBack}, {kFloor, kCeiling}};
  for (int axis = 0; axis < 3; ++axis) {
    const float along = ray.direction[axis];
    if (along == 0) continue;
    const bool is_high = along > 0;
    const float distance = ((is_high ? high_ : low_)[axis] - ray.origin[axis]) / along;
    if (distance < hit.distance) hit = {distance, kFaces[axis][is_high]};
  }
  return hit;
}

bool ArenaScene::meets(const Ray& ray, int object, Hit* hit) const {
  const Round& round = rounds_[static_cast<size_t>(object)];
  float distance = toSide(ray, round);
  if (!round.is_ball) distance = std::min(distance, toTop(ray, round));
  if (distance >= hit->distance) return false;
  *hit = {distance, kBackgrounds + object};
  return true;
}

float ArenaScene::toSide(const Ray& ray, const Round& round) {
  const Vector3f from = ray.origin - round.position;
  // A cylinder is a circle as seen from above.
  const int axes = round.is_ball ? 3 : 2;
  const float a = ray.direction.head(axes).squaredNorm(), b = from.head(axes).dot(ray.direction.head(axes)),
              c = from.head(axes).squaredNorm() - round.radius * round.radius;
  const float discriminant = b * b - a * c;
  if (a <= 0 || discriminant < 0) return kNever;
  const float distance = (-b - std::sqrt(discriminant)) / a;
  const float z = from.z() + distance * ray.direction.z();
  const bool is_side = round.is_ball || (z >= 0 && z <= round.height);
  return distance > 0 && is_side ? distance : kNever;
}

float ArenaScene::toTop(const Ray& ray, const Round& round) {
  const Vector3f from = ray.origin - round.position;
  if (ray.direction.z() == 0) return kNever;
  const float distance = (round.height - from.z()) / ray.direction.z();
  const Eigen::Vector2f off = from.head<2>() + distance * ray.direction.head<2>();
  return distance > 0 && off.squaredNorm() <= round.radius * round.radius ? distance : kNever;
}

Vector3f ArenaScene::normal(const Ray& ray, const Hit& hit) const {
  switch (hit.surface) {
    case kFloor:
      return {0, 0, 1};
    case kCeiling:
      return {0, 0, -1};
    case kLeft:
      return {1, 0, 0};
    case kRight:
      return {-1, 0, 0};
    case kFront:
      return {0, 1, 0};
    case kBack:
      return {0, -1, 0};
    default:
      break;
  }
  const Round& round = rounds_[static_cast<size_t>(hit.surface - kBackgrounds)];
  Vector3f off = ray.origin + hit.distance * ray.direction - round.position;
  if (round.is_ball) return off / round.radius;
  if (off.z() > round.height - kAlmost) return {0, 0, 1};
  off.z() = 0;
  return off / round.radius;
}

Vector3f ArenaScene::reflectance(const Vector3f& point, const Hit& hit, float width) const {
  if (hit.surface >= kBackgrounds) return rounds_[static_cast<size_t>(hit.surface - kBackgrounds)].colour;
  const Vector3f at = point - low_;
  const float u = hit.surface == kLeft || hit.surface == kRight ? at.y() : at.x();
  const float v = hit.surface == kFloor || hit.surface == kCeiling ? at.y() : high_.z() - at.z();
  return arenaTexel(textures_[static_cast<size_t>(hit.surface)], u, v, width);
}

/// Fraction of the light that reaches the floor near objects.
float ArenaScene::shade(const Vector3f& point, int surface) const {
  if (surface != kFloor) return 1;
  float left = 1;
  for (const Round& round : rounds_) {
    const float height = round.is_ball ? round.position.z() - round.radius : 0;
    const float off = (point - round.position).head<2>().norm() / round.radius;
    const float reach = kContactReach + 1;
    if (off < reach && height < round.radius)
      left *= 1 - kContact * (1 - std::max(0.F, off - 1) / kContactReach);
  }
  return left;
}

Vector3f ArenaScene::light(const Ray& ray, const Hit& hit, float angle) const {
  const Vector3f point = ray.origin + hit.distance * ray.direction;
  const Vector3f n = normal(ray, hit);
  const float slant = std::max(0.05F, std::abs(n.dot(ray.direction)));
  const Vector3f colour = reflectance(point, hit, angle * hit.distance / slant);
  const float falls = ambient_ * (0.8F + 0.2F * n.z()) + direct_ * std::max(0.F, n.dot(toward_));
  return shade(point, hit.surface) * falls * colour.cwiseProduct(tint_);
}

}  // namespace sextant
