// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/simulation/arena_scene.hpp"

namespace sextant {

class ArenaTracer;

/// Parameters of DepthCamera.
struct DepthCameraParams {
  double noise = 0.004;
  double scale = 1.0;
  double baseline = 0.05;
  double min_depth = 0.28;
  double max_depth = 10.0;
  double holes = 0.01;
  int bleeding = 0;
  int seed = 1;

  ParamList fields();
};

/// Simulates a stereo depth camera such as Intel's D435. Not thread-safe.
class DepthCamera {
 public:
  /// @throws std::invalid_argument as validate(DepthCameraParams)
  DepthCamera(const DepthCameraParams& params, const CameraModel& camera);
  ~DepthCamera();

  /// Renders a depth image.
  /// @param frame seed of the noise
  /// @return 32-bit depth along the optical axis, metres; 0: invalid
  /// @throws std::invalid_argument as ArenaCamera::take()
  cv::Mat take(const ArenaScene& scene, const Pose& T_map_camera, std::uint64_t frame);

 private:
  cv::Mat_<float> visibleDepths() const;
  float measured(float depth, float noise) const;

  DepthCameraParams params_;
  double focal_length_;
  std::unique_ptr<ArenaTracer> tracer_;
  std::vector<float> noise_;  // standard normal, square tile
};

}  // namespace sextant
