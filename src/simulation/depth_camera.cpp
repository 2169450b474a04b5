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
  const int rows = tracer_->surfaces().rows, cols = tracer_->surfaces().cols;
  cv::Mat_<float> blots((rows + kHoleSize - 1) / kHoleSize, (cols + kHoleSize - 1) / kHoleSize);
  cv::RNG random = arenaRandom(frame + (static_cast<std::uint64_t>(params_.seed) << 32U));
  random.fill(blots, cv::RNG::UNIFORM, 0.0, 1.0);
  const auto reach = static_cast<float>(focal_length_ * params_.baseline);  // disparity times depth, px m
  const size_t begin = arenaNoiseAt(frame, noise_.size());
  cv::Mat_<float> image(rows, cols, 0.0F);
  for (int y = 0; y < rows; ++y) {
    const auto noise_row = begin + static_cast<size_t>(y) * kDepthPattern;
    // The right camera has a point at x - reach / depth, where nearer points occlude farther ones.
    float covered = std::numeric_limits<float>::max();
    for (int x = cols - 1; x >= 0; --x) {
      if (tracer_->surfaces()(y, x) == ArenaTracer::kNothing) continue;
      const float depth = tracer_->depth(x, y), other = static_cast<float>(x) - reach / depth;
      const bool is_hidden = other >= covered;
      covered = std::min(covered, other);
      if (!is_hidden && depth >= params_.min_depth && depth <= params_.max_depth &&
          blots(y / kHoleSize, x / kHoleSize) >= params_.holes)
        image(y, x) = measured(depth, noise_[(noise_row + static_cast<size_t>(x)) % noise_.size()]);
    }
  }
  return image;
}

float DepthCamera::measured(float depth, float noise) const {
  const auto deviation = static_cast<float>(params_.noise) * depth * depth;
  return static_cast<float>(params_.scale) * std::max(0.F, depth + deviation * noise);
}

}  // namespace sextant
