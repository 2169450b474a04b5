// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/arena_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

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
constexpr float kOffSurface = 1e-3F;   // metres; start of a ray from a surface
constexpr float kFlatFloor = 0.04F;    // reflection straight down, of varnish or plastic
constexpr float kBlurredAngle = 0.01F;  // radians; blur of a reflection
constexpr int kMaxRows = 2000;          // of the texture of a photo
constexpr float kSmudgesOff = 30.0F;    // metres; smudges have no negative coordinates
constexpr double kDisplayGamma = 2.2;   // of photos

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
      {"shadows", &shadows, Range::closed(0, 1), "", "fraction of the directional light that objects block"},
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
      {"gloss", &gloss, Range::closed(0, 1), "",
       "reflection of the floor; 1: as of a mirror at a flat angle (Schlick 1994)"},
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
  smudges_ = arenaPyramid(arenaSmudges(random));
}

void ArenaScene::setObjects(const std::vector<ArenaObject>& objects) {
  std::vector<Solid> solids;
  for (const ArenaObject& each : objects) {
    Range::openLow(0, 10).require("radius", each.radius, "m");
    Range::openLow(0, 10).require("height", each.height, "m");
    for (int side = 0; side < 2; ++side) Range::openLow(0, 10).require("sides", each.sides[side], "m");
    Range::closed(0, 1).require("dirt", each.dirt);
    requireColour("colour", each.colour, 1);
    solids.push_back({each.shape, each.position.cast<float>(), each.colour.cast<float>(),
                      static_cast<float>(each.radius), static_cast<float>(each.height),
                      static_cast<float>(each.dirt), 0.5F * each.sides.cast<float>(),
                      Eigen::Rotation2Df(static_cast<float>(each.yaw))});
  }
  objects_ = objects;
  solids_ = solids;
}

void ArenaScene::setTexture(int surface, const cv::Mat& photo, double width) {
  Range::closed(0, kBackgrounds - 1).require("surface", surface);
  Range::closed(0.1, 20).require("width", width, "m");
  if (photo.empty() || photo.type() != CV_8UC3) throw std::invalid_argument("a texture must be an RGB photo");
  const int columns = static_cast<int>(width * kArenaTexels);
  const cv::Size size(columns, std::clamp(columns * photo.rows / photo.cols, 1, kMaxRows));
  cv::Mat scaled, texture;
  cv::resize(photo, scaled, size, 0, 0, cv::INTER_AREA);
  scaled.convertTo(texture, CV_32FC3, 1 / 255.0);
  cv::pow(texture, kDisplayGamma, texture);
  textures_[static_cast<size_t>(surface)] = arenaPyramid(texture);
}

void ArenaScene::setLight(const ArenaLight& light) {
  validate(light);
  tint_ = (light.brightness * light.tint).cast<float>();
  direct_ = static_cast<float>(light.direct);
  ambient_ = 1 - direct_;
  shadows_ = static_cast<float>(light.shadows);
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
  const Solid& solid = solids_[static_cast<size_t>(object)];
  float distance = solid.shape == ArenaObject::Shape::box ? toBox(ray, solid) : toRound(ray, solid);
  if (solid.shape == ArenaObject::Shape::pillar) distance = std::min(distance, toTop(ray, solid));
  if (distance >= hit->distance) return false;
  *hit = {distance, kBackgrounds + object};
  return true;
}

ArenaScene::Hit ArenaScene::first(const Ray& ray) const {
  Hit hit = background(ray);
  for (size_t object = 0; object < solids_.size(); ++object) meets(ray, static_cast<int>(object), &hit);
  return hit;
}

float ArenaScene::toRound(const Ray& ray, const Solid& round) {
  const Vector3f from = ray.origin - round.position;
  const bool is_ball = round.shape == ArenaObject::Shape::ball;
  // A cylinder is a circle as seen from above.
  const int axes = is_ball ? 3 : 2;
  const float a = ray.direction.head(axes).squaredNorm(), b = from.head(axes).dot(ray.direction.head(axes)),
              c = from.head(axes).squaredNorm() - round.radius * round.radius;
  const float discriminant = b * b - a * c;
  if (a <= 0 || discriminant < 0) return kNever;
  const float distance = (-b - std::sqrt(discriminant)) / a;
  const float z = from.z() + distance * ray.direction.z();
  const bool is_side = is_ball || (z >= 0 && z <= round.height);
  return distance > 0 && is_side ? distance : kNever;
}

float ArenaScene::toTop(const Ray& ray, const Solid& pillar) {
  const Vector3f from = ray.origin - pillar.position;
  if (ray.direction.z() == 0) return kNever;
  const float distance = (pillar.height - from.z()) / ray.direction.z();
  const Eigen::Vector2f off = from.head<2>() + distance * ray.direction.head<2>();
  return distance > 0 && off.squaredNorm() <= pillar.radius * pillar.radius ? distance : kNever;
}

/// The ray is between all three pairs of faces from the last entry to the first exit (Kay and Kajiya 1986).
float ArenaScene::toBox(const Ray& ray, const Solid& box) {
  Vector3f from = ray.origin - box.position, along = ray.direction;
  from.head<2>() = box.turn.inverse() * from.head<2>();
  along.head<2>() = box.turn.inverse() * along.head<2>();
  const Vector3f low(-box.half.x(), -box.half.y(), 0), high(box.half.x(), box.half.y(), box.height);
  float enter = 0, leave = kNever;
  for (int axis = 0; axis < 3; ++axis) {
    const float per = 1 / along[axis];  // infinite for a parallel ray
    const float one = (low[axis] - from[axis]) * per, other = (high[axis] - from[axis]) * per;
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  }
  return enter > 0 && enter <= leave ? enter : kNever;
}

/// Normal of the nearest face.
Vector3f ArenaScene::boxNormal(const Vector3f& from_foot, const Solid& box) {
  Vector3f at = from_foot;
  at.head<2>() = box.turn.inverse() * at.head<2>();
  at.z() -= 0.5F * box.height;
  const Vector3f half(box.half.x(), box.half.y(), 0.5F * box.height);
  int axis = 0;
  (half - at.cwiseAbs()).minCoeff(&axis);
  Vector3f normal = Vector3f::Zero();
  normal[axis] = at[axis] < 0 ? -1.0F : 1.0F;
  normal.head<2>() = box.turn * normal.head<2>();
  return normal;
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
  const Solid& solid = solids_[static_cast<size_t>(hit.surface - kBackgrounds)];
  Vector3f off = ray.origin + hit.distance * ray.direction - solid.position;
  if (solid.shape == ArenaObject::Shape::box) return boxNormal(off, solid);
  if (solid.shape == ArenaObject::Shape::ball) return off / solid.radius;
  if (off.z() > solid.height - kAlmost) return {0, 0, 1};
  off.z() = 0;
  return off / solid.radius;
}

Vector3f ArenaScene::reflectance(const Vector3f& point, const Hit& hit, float width) const {
  if (hit.surface >= kBackgrounds) {
    const Solid& solid = solids_[static_cast<size_t>(hit.surface - kBackgrounds)];
    if (solid.dirt == 0) return solid.colour;
    // In the frame of a box both axes of the smudges change along each of its faces.
    Vector3f off = point - solid.position;
    off.head<2>() = solid.turn.inverse() * off.head<2>();
    off.array() += kSmudgesOff;
    const Vector3f smudge = arenaTexel(smudges_, off.x() + off.y(), off.z() + 0.5F * off.x(), width);
    return solid.colour * (1 - solid.dirt * smudge[0]);
  }
  const Vector3f at = point - low_;
  const float u = hit.surface == kLeft || hit.surface == kRight ? at.y() : at.x();
  const float v = hit.surface == kFloor || hit.surface == kCeiling ? at.y() : high_.z() - at.z();
  return arenaTexel(textures_[static_cast<size_t>(hit.surface)], u, v, width);
}

/// Fraction of the light that reaches the floor near objects.
float ArenaScene::shade(const Vector3f& point, int surface) const {
  if (surface != kFloor) return 1;
  float left = 1;
  for (const Solid& solid : solids_) {
    if (solid.shape == ArenaObject::Shape::box) continue;  // its cast shadow begins at its faces
    const float height = solid.position.z() - (solid.shape == ArenaObject::Shape::ball ? solid.radius : 0);
    const float off = (point - solid.position).head<2>().norm() / solid.radius;
    const float reach = kContactReach + 1;
    if (off < reach && height < solid.radius)
      left *= 1 - kContact * (1 - std::max(0.F, off - 1) / kContactReach);
  }
  return left;
}

/// Directional light on a surface.
float ArenaScene::lit(const Vector3f& point, const Vector3f& normal) const {
  const float falls = direct_ * std::max(0.F, normal.dot(toward_));
  if (falls == 0 || shadows_ == 0) return falls;
  const Ray back{point + kOffSurface * normal, toward_};
  Hit blocked{kNever, kFloor};
  for (size_t object = 0; object < solids_.size(); ++object)
    if (meets(back, static_cast<int>(object), &blocked)) return falls * (1 - shadows_);
  return falls;
}

Vector3f ArenaScene::scattered(const Ray& ray, const Hit& hit, float angle) const {
  const Vector3f point = ray.origin + hit.distance * ray.direction;
  const Vector3f n = normal(ray, hit);
  const float slant = std::max(0.05F, std::abs(n.dot(ray.direction)));
  const Vector3f colour = reflectance(point, hit, angle * hit.distance / slant);
  const float falls = ambient_ * (0.8F + 0.2F * n.z()) + lit(point, n);
  return shade(point, hit.surface) * falls * colour.cwiseProduct(tint_);
}

Vector3f ArenaScene::light(const Ray& ray, const Hit& hit, float angle) const {
  const Vector3f light = scattered(ray, hit, angle);
  if (params_.gloss == 0 || hit.surface != kFloor) return light;
  Ray mirrored{ray.origin + hit.distance * ray.direction, ray.direction};
  mirrored.origin.z() = kOffSurface;
  mirrored.direction.z() = -ray.direction.z();
  const auto share = static_cast<float>(params_.gloss) *
                     (kFlatFloor + (1 - kFlatFloor) * std::pow(1 + ray.direction.z(), 5.F));
  return light + share * (scattered(mirrored, first(mirrored), kBlurredAngle) - light);
}

}  // namespace sextant
