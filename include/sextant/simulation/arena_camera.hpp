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

/// Parameters of ArenaCamera.
struct ArenaCameraParams {
  int supersampling = 2;
  double blur_sigma = 0.6;
  double noise_sigma = 4.0;
  double white_level = 230;
  double gamma = 2.2;
  int seed = 1;

  ParamList fields();
};

/// The visible part of an object in an image.
struct VisibleObject {
  int object = 0;              ///< index of the object in the scene
  Eigen::Vector2i low{0, 0};   ///< first pixel of the bounding box
  Eigen::Vector2i high{0, 0};  ///< pixel after its last one
  int pixels = 0;              ///< number of visible pixels
};

/// Renders colour images of an arena. Not thread-safe.
class ArenaCamera {
 public:
  /// @throws std::invalid_argument as validate(ArenaCameraParams)
  ArenaCamera(const ArenaCameraParams& params, const CameraModel& camera);
  ~ArenaCamera();

  /// A rendered image with its ground truth.
  struct Frame {
    cv::Mat image;                       ///< 8-bit RGB; black where the lens model has no ray
    std::vector<VisibleObject> objects;  ///< objects in the image, with their bounding boxes
  };
  /// Renders an image.
  /// @param frame seed of the noise; the same scene, pose and frame give the same bytes
  /// @throws std::invalid_argument for a camera outside the arena
  Frame take(const ArenaScene& scene, const Pose& T_map_camera, std::uint64_t frame);

  /// Pixels of the last image in which an object is visible: 255, others 0.
  cv::Mat mask() const;

 private:
  void colour(const ArenaScene& scene);
  Eigen::Vector3f average(const ArenaScene& scene, int x, int y) const;
  cv::Mat expose(std::uint64_t frame) const;

  ArenaCameraParams params_;
  std::unique_ptr<ArenaTracer> tracer_;
  cv::Mat_<cv::Vec3f> light_;
  std::vector<float> noise_;          // standard normal
  std::vector<std::uint8_t> levels_;  // grey level by light
};

}  // namespace sextant
