// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/simulation/room_scene.hpp"

namespace sextant {

/// Parameters of RoomRenderer.
struct RoomRendererParams {
  int supersampling = 4;
  double blur_sigma = 0.5;
  double noise_sigma = 4.0;
  double vignette = 0.25;
  double white_level = 200.0;
  int seed = 1;

  ParamList fields();
};

/// Renders images of a room by ray casting with the full camera model, so that a point of the scene appears
/// exactly at its CameraModel::project(). Light is averaged before the conversion to grey levels (a linear
/// sensor). Not thread-safe: use one renderer per thread.
class RoomRenderer {
 public:
  /// @throws std::invalid_argument as validate(RoomRendererParams), or without a scene
  RoomRenderer(const RoomRendererParams& params, std::shared_ptr<const RoomScene> scene,
               const CameraModel& camera);

  /// Renders an image.
  /// @param exposure T_map_camera at equal steps of the exposure time; one pose for an image without motion
  /// blur
  /// @param frame seed of the noise; the same poses and frame give the same bytes
  /// @return 8-bit grey; black where the lens model has no ray
  /// @throws std::invalid_argument without a pose, or for a camera outside the room
  cv::Mat render(const std::vector<Pose>& exposure, std::uint64_t frame) const;

 private:
  struct Tile;
  struct Shot;
  const Eigen::Vector3f& rayAt(int x, int y) const {
    return rays_[static_cast<std::size_t>(y + 1) * (camera_.width() + 2) + (x + 1)];
  }
  void makeRays();
  void makeVignette();
  cv::Mat_<float> radiance(const Pose& T_map_camera) const;
  std::vector<Tile> tiles(const Pose& T_map_camera) const;
  cv::Rect boundingBox(int object, const Pose& T_camera_map) const;
  void traceTile(const Tile& tile, Shot* shot) const;
  int traceFace(const Tile& tile, Shot* shot) const;
  void tracePixels(const Tile& tile, int background, Shot* shot) const;
  void refineTile(const Tile& tile, const cv::Mat_<std::uint8_t>& edges, Shot* shot) const;
  float supersample(int x, int y, const Shot& shot, const std::vector<int>& objects) const;
  cv::Mat expose(const cv::Mat_<float>& radiance, std::uint64_t frame) const;

  RoomRendererParams params_;
  std::shared_ptr<const RoomScene> scene_;
  CameraModel camera_;
  float pixel_angle_;                     // rad
  std::vector<Eigen::Vector3f> rays_;     // optical frame, with a margin of one pixel; zero: no ray
  std::vector<Eigen::Vector2f> samples_;  // positions within a pixel, [-0.5, 0.5]
  cv::Mat_<float> gain_;                  // grey levels per unit of light
  std::vector<float> noise_;              // standard normal
};

}  // namespace sextant
