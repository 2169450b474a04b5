// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/corner_noise.hpp"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr double kEnough = 200.0;   // degrees of freedom before which nothing is said
constexpr double kMemory = 4000.0;  // degrees of freedom after which the past is forgotten
constexpr double kLeast = 0.05, kMost = 10.0;

}  // namespace

// Six of the 8 n residuals of n markers are spent on the pose.
void CornerNoise::add(const LocatedPose& pose) {
  const double n = static_cast<double>(pose.used().size());
  if (n < 2) return;  // one marker's pose takes up six of its eight, and with them what is wrong
  for (const LocatedMarker& marker : pose.markers) {
    if (!marker.used) continue;
    if (marker.camera_index >= cameras_.size()) cameras_.resize(marker.camera_index + 1);
    const double before = scale(marker.camera_index);
    Camera& camera = cameras_[marker.camera_index];
    const double keep = std::exp(-(8 - 6 / n) / kMemory);
    camera.squares = keep * camera.squares + marker.squared_distance * before * before;
    camera.freedoms = keep * camera.freedoms + 8 - 6 / n;
  }
}

double CornerNoise::scale(size_t camera) const {
  if (camera >= cameras_.size() || cameras_[camera].freedoms < kEnough) return 1.0;
  return std::clamp(std::sqrt(cameras_[camera].squares / cameras_[camera].freedoms), kLeast, kMost);
}

}  // namespace sextant
