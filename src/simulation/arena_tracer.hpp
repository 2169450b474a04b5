// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/simulation/arena_scene.hpp"

namespace sextant {

/// Intersects the ray of every pixel with the scene.
class ArenaTracer {
 public:
  static constexpr std::uint16_t kNothing = 0xFFFF;  // the lens model has no ray there

  explicit ArenaTracer(const CameraModel& camera);

  /// Traces all pixels.
  /// @throws std::invalid_argument for a camera outside the room
  void trace(const ArenaScene& scene, const Pose& T_map_camera);

  /// The ray of a pixel. @param off offset from the pixel's centre, pixels
  ArenaScene::Ray ray(int x, int y, const Eigen::Vector2f& off = {0, 0}) const;
  const cv::Mat_<float>& distances() const { return distances_; }                 ///< along the ray, metres
  const cv::Mat_<std::uint16_t>& surfaces() const { return surfaces_; }           ///< as ArenaScene::Hit
  float depth(int x, int y) const { return distances_(y, x) * rayAt(x, y).z(); }  ///< along the optical axis
  float pixelAngle() const { return pixel_angle_; }                               ///< radians

 private:
  const Eigen::Vector3f& rayAt(int x, int y) const {
    return rays_[static_cast<size_t>(y * (width_ + 1) + x)];
  }
  void traceBackground(const ArenaScene& scene);
  void traceObject(const ArenaScene& scene, int object, const cv::Rect& box);
  cv::Rect boxOf(const ArenaObject& object, const Pose& T_camera_map) const;

  CameraModel camera_;
  int width_, height_;
  float pixel_angle_;
  std::vector<Eigen::Vector3f> rays_;  // optical frame, unit; one extra column and row; zero: no ray
  Eigen::Matrix3f R_map_camera_;
  Eigen::Vector3f origin_;
  cv::Mat_<float> distances_;
  cv::Mat_<std::uint16_t> surfaces_;
};

}  // namespace sextant
