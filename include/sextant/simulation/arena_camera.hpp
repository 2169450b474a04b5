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

struct ArenaCameraParams {
  int supersampling = 2;
  double blur_sigma = 0.6;
  double noise_sigma = 4.0;
  double white_level = 230;
  double gamma = 2.2;
  int seed = 1;

  ParamList fields();
};

/// What of an object a picture shows.
struct SeenObject {
  int object = 0;                         ///< index
  Eigen::Vector2i low{0, 0}, high{0, 0};  ///< corners of the box about it, pixels; high is the first outside
  int pixels = 0;                         ///< that show it
};

/// Takes colour pictures in an arena. Not thread-safe.
class ArenaCamera {
 public:
  /// @throws std::invalid_argument as validate(ArenaCameraParams)
  ArenaCamera(const ArenaCameraParams& params, const CameraModel& camera);
  ~ArenaCamera();

  struct Picture {
    cv::Mat image;  ///< 8-bit red, green, blue; black where the lens model has no ray
    std::vector<SeenObject> seen;
  };
  /// @param frame chooses the noise; the same scene, pose and frame give the same bytes
  /// @throws std::invalid_argument for a camera that is outside of the arena
  Picture take(const ArenaScene& scene, const Pose& T_map_camera, std::uint64_t frame);

 private:
  void colour(const ArenaScene& scene);
  Eigen::Vector3f average(const ArenaScene& scene, int x, int y) const;
  cv::Mat expose(std::uint64_t frame) const;

  ArenaCameraParams params_;
  std::unique_ptr<ArenaTracer> tracer_;
  cv::Mat_<cv::Vec3f> light_;
  std::vector<float> noise_;          // standard normal
  std::vector<std::uint8_t> levels_;  // by light
};

}  // namespace sextant
