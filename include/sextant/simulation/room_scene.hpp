// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/simulation/room_texture.hpp"

namespace sextant {

/// A box with its sides parallel to the map's axes, such as a cupboard, a crate or a post.
struct RoomObstacle {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< metres, map
  Eigen::Vector3d size = Eigen::Vector3d::Ones();    ///< metres, each > 0
  double reflectance = 0.5;                          ///< [0, 1]
};

/// Size and contents of a room.
struct RoomSceneParams {
  Eigen::Vector3d size{6.0, 6.0, 2.5};
  Eigen::Vector3d floor_center = Eigen::Vector3d::Zero();
  double quiet_zone = 1.0;
  double light_unevenness = 1.0;
  int seed = 1;
  /// boxes in the room
  std::vector<RoomObstacle> obstacles = {
      {{1.6, 0.2, 1.25}, {0.06, 0.06, 2.5}, 0.7},  // post
      {{-0.6, -2.2, 1.25}, {0.1, 0.1, 2.5}, 0.3},  // post
      {{-2.5, 2.5, 0.55}, {0.7, 0.7, 1.1}, 0.5},   // crate
      {{2.55, -2.6, 0.9}, {0.5, 0.5, 1.8}, 0.25},  // cupboard
  };

  ParamList fields();  ///< without the obstacles
};

/// Checks all fields, including the obstacles.
/// @throws std::invalid_argument with the name of the first field out of range
void validate(const RoomSceneParams& params);

/// A ray.
struct RoomRay {
  Eigen::Vector3f origin;     ///< metres, map
  Eigen::Vector3f direction;  ///< unit vector
};

/// First intersection of a ray.
struct RoomHit {
  float distance;  ///< metres
  int surface;     ///< number of the surface; equal for parts of one plane and colour
  float u;         ///< position on the surface, metres
  float v;         ///< position on the surface, metres
  float detail;    ///< angular size of the smallest detail of the surface, rad
};

/// A box-shaped room with furniture and printed markers: ray intersections and light.
class RoomScene {
 public:
  /// @throws std::invalid_argument as validate(RoomSceneParams), or for a marker outside the room
  RoomScene(const RoomSceneParams& params, const MarkerMap& map);

  /// Parameters given at construction.
  const RoomSceneParams& params() const { return params_; }
  bool contains(const Eigen::Vector3d& p_map) const;  ///< whether a point is in the room
  /// Number of objects: obstacles and marker boards.
  int objectCount() const { return static_cast<int>(obstacles_.size() + boards_.size()); }
  /// Points on an object's outline, map.
  std::vector<Eigen::Vector3d> outline(int object) const;

  /// Intersects a ray with the room and some objects.
  /// @param ray starts in the room
  /// @param objects indices of the objects that the ray may meet
  RoomHit trace(const RoomRay& ray, const std::vector<int>& objects) const;

  /// Light from a hit: illumination times reflectance; 1 is white paper in the room's mean light.
  /// @param footprint width of the ray at the hit, metres
  float radiance(const RoomRay& ray, const RoomHit& hit, float footprint) const;
  /// Light that arrives at a point.
  float illumination(const Eigen::Array3f& p_map) const;

  /// Reflectance for neighbouring rays that all meet one side of the room; fast path for most of an image.
  /// @param face a surface below kFaces
  /// @param rays `count` directions in the camera frame; they start at the camera
  /// @param footprint width of the rays at the face, metres
  void faceReflectance(int face, const Eigen::Isometry3f& T_map_camera, const Eigen::Vector3f* rays,
                       int count, float footprint, float* reflectance) const;
  static constexpr int kFaces = 6;  ///< surfaces 0 to 5 are the room's sides: -x +x -y +y -z +z

 private:
  // A marker with its quiet zone; the back is grey.
  struct Board {
    Eigen::Vector3f center;
    Eigen::Matrix3f R_marker_map;
    cv::Mat_<std::uint8_t> modules;
    float module;         // metres
    float marker_middle;  // modules, from the edge of the modules image
    float begin;          // begin and end of the quiet zone, modules
    float end;
  };
  struct Obstacle {
    Eigen::Array3f low;
    Eigen::Array3f high;
    float reflectance;
  };

  static Board makeBoard(const MappedMarker& marker, double quiet_zone);
  RoomHit hitRoom(const RoomRay& ray, const Eigen::Array3f& inverse_direction) const;
  void hitObstacle(int index, const RoomRay& ray, const Eigen::Array3f& inverse_direction,
                   RoomHit* hit) const;
  void hitBoard(int index, const RoomRay& ray, RoomHit* hit) const;
  float reflectance(const RoomHit& hit, float footprint) const;

  RoomSceneParams params_;
  Eigen::Array3f low_;
  Eigen::Array3f high_;
  Eigen::Array3f inverse_size_;
  std::vector<RoomTexture> faces_;  // -x +x -y +y -z +z
  std::vector<Obstacle> obstacles_;
  std::vector<Board> boards_;
};

}  // namespace sextant
