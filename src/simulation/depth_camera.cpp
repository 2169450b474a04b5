// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/depth_camera.hpp"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "arena_noise.hpp"
#include "arena_tracer.hpp"

namespace sextant {
namespace {

constexpr int kHoleSize = 4;            // pixels
constexpr int kDepthPattern = 1 << 10;  // side of the periodic noise tile, pixels
constexpr float kEdge = 0.1F;           // metres; smaller steps do not bleed
constexpr int kWindow = 7;              // side of a stereo matcher's window, pixels
/// A periodic tile of standard normal numbers, averaged over a stereo matcher's window, so that neighbours
/// are correlated.
std::vector<float> windowNoise(int seed) {
  std::vector<float> numbers = arenaNoise(seed, kDepthPattern * kDepthPattern);
  cv::Mat tile(kDepthPattern, kDepthPattern, CV_32F, numbers.data()), wide;
  constexpr int kHalf = kWindow / 2;
  cv::copyMakeBorder(tile, wide, kHalf, kHalf, kHalf, kHalf, cv::BORDER_WRAP);
  cv::boxFilter(wide, wide, CV_32F, {kWindow, kWindow});
  cv::Scalar mean, deviation;
  wide = wide(cv::Rect(kHalf, kHalf, kDepthPattern, kDepthPattern));
  cv::meanStdDev(wide, mean, deviation);
  wide.convertTo(tile, CV_32F, 1 / deviation[0], -mean[0] / deviation[0]);
  return numbers;
}

/// Between near and far, depths become means over a window: "flying pixels". Holes stay.
void bleed(cv::Mat_<float>& depth, int reach) {
  const cv::Mat is_valid = depth > 0;
  cv::Mat nearest = depth.clone(), farthest, sums, weights, valid;
  nearest.setTo(std::numeric_limits<float>::max(), depth == 0);
  const cv::Mat window = cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8U);
  cv::erode(nearest, nearest, window);
  cv::dilate(depth, farthest, window);
  is_valid.convertTo(valid, CV_32F, 1 / 255.0);
  cv::boxFilter(depth, sums, CV_32F, window.size());
  cv::boxFilter(valid, weights, CV_32F, window.size());
  const cv::Mat means = sums / cv::max(weights, 1e-6), is_edge = (farthest - nearest > kEdge) & is_valid;
  means.copyTo(depth, is_edge);
}

}  // namespace

ParamList DepthCameraParams::fields() {
  return {
      {"noise", &noise, Range::closed(0, 1), "m",
       "standard deviation at 1 m, growing with the square of the depth; correlated between neighbouring "
       "pixels"},
      {"scale", &scale, Range::closed(0.5, 2), "", "scale error: measured over true depth"},
      {"baseline", &baseline, Range::closed(0, 1), "m",
       "baseline of the stereo pair: points that only one camera sees have no depth"},
      {"min_depth", &min_depth, Range::closed(0, 10), "m", "minimum depth"},
      {"max_depth", &max_depth, Allowed(Range::openLow(min_depth, 100), "(`min_depth`, 100]"), "m",
       "maximum depth"},
      {"holes", &holes, Range::closed(0, 1), "", "fraction of the other pixels without depth"},
      {"bleeding", &bleeding, Range::closed(0, 20), "px",
       "reach of the mixed depths at edges, where near and far run into each other; 0: sharp edges"},
      {"seed", &seed, Range::closed(0, std::numeric_limits<int>::max()), "", "seed of noise and holes"},
  };
}

DepthCamera::DepthCamera(const DepthCameraParams& params, const CameraModel& camera)
    : params_(params),
      focal_length_(camera.focalLength()),
      tracer_(std::make_unique<ArenaTracer>(camera)),
      noise_(windowNoise(params.seed)) {
  validate(params);
}

DepthCamera::~DepthCamera() = default;

cv::Mat DepthCamera::take(const ArenaScene& scene, const Pose& T_map_camera, std::uint64_t frame) {
  tracer_->trace(scene, T_map_camera);
  cv::Mat_<float> image = visibleDepths();
  if (params_.bleeding > 0) bleed(image, params_.bleeding);
  cv::Mat_<float> blots((image.rows + kHoleSize - 1) / kHoleSize, (image.cols + kHoleSize - 1) / kHoleSize);
  cv::RNG random = arenaRandom(frame + (static_cast<std::uint64_t>(params_.seed) << 32U));
  random.fill(blots, cv::RNG::UNIFORM, 0.0, 1.0);
  const size_t begin = arenaNoiseAt(frame, noise_.size());
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const size_t at = begin + static_cast<size_t>(y) * kDepthPattern + static_cast<size_t>(x);
      const bool is_hole = image(y, x) == 0 || blots(y / kHoleSize, x / kHoleSize) < params_.holes;
      image(y, x) = is_hole ? 0 : measured(image(y, x), noise_[at % noise_.size()]);
    }
  return image;
}

/// True depths that both cameras of the stereo pair see, within range; 0: none.
cv::Mat_<float> DepthCamera::visibleDepths() const {
  const auto& surfaces = tracer_->surfaces();
  const auto reach = static_cast<float>(focal_length_ * params_.baseline);  // disparity times depth, px m
  cv::Mat_<float> depths(surfaces.size(), 0.0F);
  for (int y = 0; y < depths.rows; ++y) {
    // The right camera has a point at x - reach / depth, where nearer points occlude farther ones.
    float covered = std::numeric_limits<float>::max();
    for (int x = depths.cols - 1; x >= 0; --x) {
      if (surfaces(y, x) == ArenaTracer::kNothing) continue;
      const float depth = tracer_->depth(x, y), other = static_cast<float>(x) - reach / depth;
      if (other < covered && depth >= params_.min_depth && depth <= params_.max_depth) depths(y, x) = depth;
      covered = std::min(covered, other);
    }
  }
  return depths;
}

float DepthCamera::measured(float depth, float noise) const {
  const auto deviation = static_cast<float>(params_.noise) * depth * depth;
  return static_cast<float>(params_.scale) * std::max(0.F, depth + deviation * noise);
}

}  // namespace sextant
