// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/arena_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "arena_noise.hpp"
#include "arena_tracer.hpp"

namespace sextant {
namespace {

using Eigen::Vector3f;

constexpr int kNoiseTable = 1 << 18;
constexpr int kLevels = 4096;  // steps of light up to kMaxLight
constexpr float kMaxLight = 2.0F;

std::vector<VisibleObject> visibleObjects(const cv::Mat_<std::uint16_t>& surfaces, size_t count) {
  std::vector<VisibleObject> all(count);
  for (size_t i = 0; i < count; ++i) {
    all[i].object = static_cast<int>(i);
    all[i].low = {surfaces.cols, surfaces.rows};
  }
  for (int y = 0; y < surfaces.rows; ++y)
    for (int x = 0; x < surfaces.cols; ++x) {
      const int surface = surfaces(y, x);
      if (surface < ArenaScene::kBackgrounds || surface == ArenaTracer::kNothing) continue;
      VisibleObject& object = all[static_cast<size_t>(surface - ArenaScene::kBackgrounds)];
      object.low = object.low.cwiseMin(Eigen::Vector2i(x, y));
      object.high = object.high.cwiseMax(Eigen::Vector2i(x + 1, y + 1));
      ++object.pixels;
    }
  all.erase(
      std::remove_if(all.begin(), all.end(), [](const VisibleObject& each) { return each.pixels == 0; }),
      all.end());
  return all;
}

}  // namespace

ParamList ArenaCameraParams::fields() {
  return {
      {"supersampling", &supersampling, Range::closed(1, 8), "", "n * n rays per pixel at edges"},
      {"blur_sigma", &blur_sigma, Range::closed(0, 20), "px", "standard deviation of the lens blur"},
      {"noise_sigma", &noise_sigma, Range::closed(0, 100), "levels",
       "standard deviation of the sensor noise"},
      {"white_level", &white_level, Range::openLow(0, 1000), "levels",
       "grey level of a white surface in light of brightness 1"},
      {"gamma", &gamma, Range::closed(0.5, 4), "", "gamma of the camera's response curve"},
      {"seed", &seed, Range::closed(0, std::numeric_limits<int>::max()), "", "seed of the noise"},
  };
}

ArenaCamera::ArenaCamera(const ArenaCameraParams& params, const CameraModel& camera)
    : params_(params),
      tracer_(std::make_unique<ArenaTracer>(camera)),
      light_(camera.height(), camera.width()),
      noise_(arenaNoise(params.seed, kNoiseTable)) {
  validate(params);
  for (int i = 0; i < kLevels; ++i) {
    const double light = (i + 0.5) * kMaxLight / kLevels;
    levels_.push_back(
        cv::saturate_cast<std::uint8_t>(params.white_level * std::pow(light, 1 / params.gamma)));
  }
}

ArenaCamera::~ArenaCamera() = default;

ArenaCamera::Frame ArenaCamera::take(const ArenaScene& scene, const Pose& T_map_camera, std::uint64_t frame) {
  tracer_->trace(scene, T_map_camera);
  colour(scene);
  return {expose(frame), visibleObjects(tracer_->surfaces(), scene.objects().size())};
}

cv::Mat ArenaCamera::mask() const {
  const auto& surfaces = tracer_->surfaces();
  return (surfaces >= ArenaScene::kBackgrounds) & (surfaces != ArenaTracer::kNothing);
}

void ArenaCamera::colour(const ArenaScene& scene) {
  const auto& surfaces = tracer_->surfaces();
  cv::Mat low, high;
  cv::erode(surfaces, low, cv::Mat());
  cv::dilate(surfaces, high, cv::Mat());
  for (int y = 0; y < light_.rows; ++y)
    for (int x = 0; x < light_.cols; ++x) {
      Vector3f light = Vector3f::Zero();
      if (surfaces(y, x) != ArenaTracer::kNothing) {
        const bool is_edge = low.at<std::uint16_t>(y, x) != high.at<std::uint16_t>(y, x);
        light = is_edge ? average(scene, x, y)
                        : scene.light(tracer_->ray(x, y), {tracer_->distances()(y, x), surfaces(y, x)},
                                      tracer_->pixelAngle());
      }
      light_(y, x) = {light[0], light[1], light[2]};
    }
}

Vector3f ArenaCamera::average(const ArenaScene& scene, int x, int y) const {
  const int n = params_.supersampling;
  Vector3f sum = Vector3f::Zero();
  for (int i = 0; i < n * n; ++i) {
    const Eigen::Vector2f cell(static_cast<float>(i % n), static_cast<float>(i / n));
    const Eigen::Vector2f off = (cell.array() + 0.5F) / static_cast<float>(n) - 0.5F;
    const ArenaScene::Ray ray = tracer_->ray(x, y, off);
    sum += scene.light(ray, scene.first(ray), tracer_->pixelAngle());
  }
  return sum / static_cast<float>(n * n);
}

cv::Mat ArenaCamera::expose(std::uint64_t frame) const {
  cv::Mat_<cv::Vec3f> light = light_;
  if (params_.blur_sigma > 0) cv::GaussianBlur(light_, light, {}, params_.blur_sigma);
  cv::Mat_<cv::Vec3b> image(light.size());
  size_t at = arenaNoiseAt(frame, noise_.size());
  const auto sigma = static_cast<float>(params_.noise_sigma);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        const int level = static_cast<int>(light(y, x)[c] * (kLevels / kMaxLight));
        at = at + 1 == noise_.size() ? 0 : at + 1;
        image(y, x)[c] = cv::saturate_cast<std::uint8_t>(
            static_cast<float>(levels_[static_cast<size_t>(std::clamp(level, 0, kLevels - 1))]) +
            sigma * noise_[at]);
      }
  return image;
}

}  // namespace sextant
