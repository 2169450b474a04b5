// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/room_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "sextant/base/range.hpp"
#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

enum BoardSurface { kBlack, kWhite, kBoardBack, kBoardSurfaces };
constexpr float kBoardReflectance[kBoardSurfaces] = {0.06F, 1.0F, 0.4F};
constexpr float kFaceShade[RoomScene::kFaces] = {0.85F, 0.95F, 0.8F,
                                                 1.0F,  0.5F,  1.1F};  // distinguishes a box's sides
constexpr float kNoDetail = std::numeric_limits<float>::infinity();
// Distance of a board from its wall, so that it is in front, metres.
constexpr float kBoardThickness = 0.004F;

void validateObstacle(const RoomObstacle& obstacle) {
  for (int i = 0; i < 3; ++i) {
    Range::closed(-1e5, 1e5).require("obstacles.center", obstacle.center[i], "m");
    Range::openLow(0, 1e5).require("obstacles.size", obstacle.size[i], "m");
  }
  Range::closed(0, 1).require("obstacles.reflectance", obstacle.reflectance);
}

// Axes u and v of a face and its normal axis.
struct FaceAxes {
  int u, v;
};
constexpr FaceAxes kFaceAxes[3] = {{1, 2}, {0, 2}, {0, 1}};
// Whether the map's axis u points left for a viewer of the face.
bool isMirrored(int face) { return face == 1 || face == 2; }

// Modules outside the image are the white quiet zone.
bool isBlack(const cv::Mat_<std::uint8_t>& modules, const cv::Point& module) {
  return cv::Rect({}, modules.size()).contains(module) && modules(module) < 128;
}

}  // namespace

ParamList RoomSceneParams::fields() {
  return {
      {"size", Numbers{size.data(), 3}, Range::closed(0.5, 1000), "m", "inner size of the room"},
      {"floor_center", Numbers{floor_center.data(), 3}, Range::closed(-1e5, 1e5), "m",
       "centre of the floor in the map"},
      {"quiet_zone", &quiet_zone, Range::closed(1, 10), "modules", "white margin around a marker"},
      {"light_unevenness", &light_unevenness, Range::closed(0, 1), "",
       "variation of the light over the room; 0: uniform"},
      {"seed", &seed, Range::closed(0, std::numeric_limits<int>::max()), "", "seed of the wall textures"},
  };
}

void validate(const RoomSceneParams& params) {
  validate<RoomSceneParams>(params);
  for (const RoomObstacle& obstacle : params.obstacles) validateObstacle(obstacle);
}

RoomScene::RoomScene(const RoomSceneParams& params, const MarkerMap& map) : params_(params) {
  validate(params);
  const Eigen::Vector3d half(0.5 * params.size.x(), 0.5 * params.size.y(), 0.0);
  low_ = (params.floor_center - half).cast<float>();
  high_ = (params.floor_center + half + Eigen::Vector3d(0, 0, params.size.z())).cast<float>();
  inverse_size_ = (high_ - low_).inverse();
  const std::uint64_t seed = 16 * (static_cast<std::uint64_t>(params.seed) + 1);
  const auto& size = params.size;
  for (int i = 0; i < 4; ++i) faces_.push_back(paintWall(i < 2 ? size.y() : size.x(), size.z(), seed + i));
  faces_.push_back(paintFloor(size.x(), size.y(), seed + 4));
  faces_.push_back(paintCeiling(size.x(), size.y(), seed + 5));
  for (const RoomObstacle& o : params.obstacles) {
    obstacles_.push_back({(o.center - 0.5 * o.size).cast<float>(), (o.center + 0.5 * o.size).cast<float>(),
                          static_cast<float>(o.reflectance)});
  }
  for (const auto& [key, marker] : map.markers()) {
    if (!contains(marker.T_map_marker.translation())) {
      throw std::invalid_argument("marker " + marker.name +
                                  " is outside the room: increase the size of the room");
    }
    boards_.push_back(makeBoard(marker, params.quiet_zone));
  }
}

RoomScene::Board RoomScene::makeBoard(const MappedMarker& marker, double quiet_zone) {
  const MarkerImage image = markerImage(marker.key.family, marker.key.id);
  Board board;
  board.center = marker.T_map_marker.translation().cast<float>();
  board.R_marker_map = marker.T_map_marker.linear().transpose().cast<float>();
  board.modules = image.modules;
  board.module = static_cast<float>(marker.size / (image.border_end - image.border_begin));
  board.marker_middle = 0.5F * static_cast<float>(image.border_begin + image.border_end);
  board.begin = static_cast<float>(-quiet_zone);
  board.end = static_cast<float>(image.modules.rows + quiet_zone);
  return board;
}

bool RoomScene::contains(const Eigen::Vector3d& p_map) const {
  const Eigen::Array3f p = p_map.cast<float>();
  return (p >= low_ - kBoardThickness).all() && (p <= high_ + kBoardThickness).all();
}

std::vector<Eigen::Vector3d> RoomScene::outline(int object) const {
  std::vector<Eigen::Vector3d> points;
  constexpr int kSteps = 8;
  const int boards_begin = static_cast<int>(obstacles_.size());
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const float a = static_cast<float>(i) / kSteps;
      const float b = static_cast<float>(j) / kSteps;
      if (object >= boards_begin) {
        const Board& board = boards_[object - boards_begin];
        const auto metres = [&board](float x) {
          return (board.begin + x * (board.end - board.begin) - board.marker_middle) * board.module;
        };
        const Eigen::Vector3f p(metres(a), -metres(b), 0.0F);
        points.emplace_back((board.R_marker_map.transpose() * p + board.center).cast<double>());
        continue;
      }
      const Obstacle& box = obstacles_[object];
      for (const auto& w : {Eigen::Array3f(a, b, 0), Eigen::Array3f(a, b, 1), Eigen::Array3f(a, 0, b),
                            Eigen::Array3f(a, 1, b), Eigen::Array3f(0, a, b), Eigen::Array3f(1, a, b)}) {
        points.emplace_back((box.low + w * (box.high - box.low)).matrix().cast<double>());
      }
    }
  }
  return points;
}

// Functions called for every ray are inline, because the compiler cannot inline exported ones.

inline RoomHit RoomScene::hitRoom(const RoomRay& ray, const Eigen::Array3f& inverse_direction) const {
  const Eigen::Array3f wall = (inverse_direction > 0.0F).select(high_, low_);
  const Eigen::Array3f distances = (wall - ray.origin.array()) * inverse_direction;
  const float sideways = std::min(distances[0], distances[1]);
  const float distance = std::min(sideways, distances[2]);
  const int axis = distances[2] < sideways ? 2 : (distances[1] < distances[0] ? 1 : 0);
  const int face = 2 * axis + (inverse_direction[axis] > 0.0F ? 1 : 0);
  const auto [u, v] = kFaceAxes[axis];
  const float along = ray.origin[u] + distance * ray.direction[u];
  const float down = ray.origin[v] + distance * ray.direction[v];
  return {distance, face, isMirrored(face) ? high_[u] - along : along - low_[u], high_[v] - down, kNoDetail};
}

inline void RoomScene::hitObstacle(int index, const RoomRay& ray, const Eigen::Array3f& inverse_direction,
                                   RoomHit* hit) const {
  const Obstacle& box = obstacles_[index];
  const Eigen::Array3f to_low = (box.low - ray.origin.array()) * inverse_direction;
  const Eigen::Array3f to_high = (box.high - ray.origin.array()) * inverse_direction;
  int axis = 0;
  const float enter = to_low.min(to_high).maxCoeff(&axis);
  const float leave = to_low.max(to_high).minCoeff();
  if (enter <= 0.0F || enter > leave || enter >= hit->distance) return;
  const int face = 2 * axis + (inverse_direction[axis] > 0.0F ? 0 : 1);
  *hit = {enter, kFaces * (1 + index) + face, 0.0F, 0.0F, kNoDetail};
}

inline void RoomScene::hitBoard(int index, const RoomRay& ray, RoomHit* hit) const {
  const Board& board = boards_[index];
  const Eigen::Vector3f p_camera = ray.origin - board.center;
  const float cosine = -board.R_marker_map.row(2).dot(ray.direction);
  const float distance = board.R_marker_map.row(2).dot(p_camera) / cosine;
  if (!(distance > 0.0F && distance < hit->distance + kBoardThickness)) return;
  const Eigen::Vector3f p = p_camera + distance * ray.direction;
  const float column = board.R_marker_map.row(0).dot(p) / board.module + board.marker_middle;
  const float row = board.marker_middle - board.R_marker_map.row(1).dot(p) / board.module;
  if (std::min(row, column) < board.begin || std::max(row, column) > board.end) return;
  const cv::Point module(static_cast<int>(std::floor(column)), static_cast<int>(std::floor(row)));
  BoardSurface surface = isBlack(board.modules, module) ? kBlack : kWhite;
  if (cosine < 0.0F) surface = kBoardBack;
  const int first = kFaces * (1 + static_cast<int>(obstacles_.size())) + kBoardSurfaces * index;
  *hit = {distance, first + surface, column, row, board.module * std::abs(cosine) / distance};
}

RoomHit RoomScene::trace(const RoomRay& ray, const std::vector<int>& objects) const {
  const Eigen::Array3f inverse_direction = ray.direction.array().inverse();
  RoomHit hit = hitRoom(ray, inverse_direction);
  const int boards_begin = static_cast<int>(obstacles_.size());
  for (const int object : objects) {
    if (object < boards_begin) {
      hitObstacle(object, ray, inverse_direction, &hit);
    } else {
      hitBoard(object - boards_begin, ray, &hit);
    }
  }
  return hit;
}

inline float RoomScene::reflectance(const RoomHit& hit, float footprint) const {
  if (hit.surface < kFaces) return faces_[hit.surface].level(footprint).reflectance(hit.u, hit.v);
  const int obstacle = hit.surface / kFaces - 1;
  const int boards_begin = static_cast<int>(obstacles_.size());
  if (obstacle < boards_begin) return obstacles_[obstacle].reflectance * kFaceShade[hit.surface % kFaces];
  return kBoardReflectance[(hit.surface - kFaces * (1 + boards_begin)) % kBoardSurfaces];
}

// A window on one side (gradient) and a lamp near a corner of the ceiling (spot).
float RoomScene::illumination(const Eigen::Array3f& p_map) const {
  const Eigen::Array3f relative = (p_map - low_) * inverse_size_;  // [0, 1]
  const float gradient = 0.2F * (relative.x() + relative.y() - 1.0F);
  const Eigen::Array3f to_lamp = relative - Eigen::Array3f(0.85F, 0.4F, 0.8F);
  const float falloff = 1.0F / (1.0F + to_lamp.square().sum() * 20.0F);
  return 1.0F + static_cast<float>(params_.light_unevenness) * (gradient + 0.35F * falloff * falloff - 0.1F);
}

float RoomScene::radiance(const RoomRay& ray, const RoomHit& hit, float footprint) const {
  const Eigen::Array3f point = ray.origin + hit.distance * ray.direction;
  return reflectance(hit, footprint) * illumination(point);
}

void RoomScene::faceReflectance(int face, const Eigen::Isometry3f& T_map_camera, const Eigen::Vector3f* rays,
                                int count, float footprint, float* reflectance) const {
  const int axis = face / 2;
  const auto [u, v] = kFaceAxes[axis];
  const Eigen::Matrix3f R = T_map_camera.linear();
  const Eigen::Vector3f p = T_map_camera.translation();
  const float side = isMirrored(face) ? -1.0F : 1.0F;
  const Eigen::RowVector3f across = R.row(axis), along = side * R.row(u), down = -R.row(v);
  const float distance = (face % 2 == 0 ? low_ : high_)[axis] - p[axis];
  const float begin_u = isMirrored(face) ? high_[u] - p[u] : p[u] - low_[u];
  const float begin_v = high_[v] - p[v];
  const RoomTexture::Level& level = faces_[face].level(footprint);
  for (int i = 0; i < count; ++i) {
    const float scale = distance / across.dot(rays[i]);
    reflectance[i] =
        level.reflectance(begin_u + scale * along.dot(rays[i]), begin_v + scale * down.dot(rays[i]));
  }
}

}  // namespace sextant
