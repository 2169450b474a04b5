// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/simulation/arena_scene.hpp"

namespace sextant {

class ArenaTracer;

struct DepthCameraParams {
  /// Deviation at 1 m, growing with the square of the depth, metres, [0, 1]; alike in pixels beside each
  /// other.
  double noise = 0.004;
  double scale = 1.0;       ///< what it says of a metre, [0.5, 2]
  double baseline = 0.05;   ///< to its other camera: what only one of them sees has no depth, metres, [0, 1]
  double min_depth = 0.28;  ///< metres, [0, 10]
  double max_depth = 10.0;  ///< metres, (min_depth, 100]
  double holes = 0.01;      ///< share of all else that has no depth, [0, 1]
  int seed = 1;             ///< >= 0

  /// @throws std::invalid_argument that names the first field out of range.
  void validate() const;
};

/// A stereo depth camera as Intel's D435. Not thread-safe.
class DepthCamera {
 public:
  /// @throws std::invalid_argument as DepthCameraParams::validate()
  DepthCamera(const DepthCameraParams& params, const CameraModel& camera);
  ~DepthCamera();

  /// @return 32-bit depth along the optical axis, metres; 0 where there is none
  /// @throws std::invalid_argument as ArenaCamera::take()
  cv::Mat take(const ArenaScene& scene, const Pose& T_map_camera, std::uint64_t frame);

 private:
  float measured(float depth, float noise) const;

  DepthCameraParams params_;
  double focal_length_;
  std::unique_ptr<ArenaTracer> tracer_;
  std::vector<float> noise_;  // standard normal, a square
};

}  // namespace sextant
