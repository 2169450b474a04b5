// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace sextant {

/// A texture with a mip map (Williams 1983, "Pyramidal parametrics").
class RoomTexture {
 public:
  /// A level of the mip map.
  struct Level {
    cv::Mat_<std::uint8_t> image;  ///< continuous
    float scale_u;                 ///< texels per metre
    float scale_v;                 ///< texels per metre

    /// Reflectance, [0, 1], at u metres to the right of and v metres below the top left corner. The border
    /// extends beyond the image.
    float reflectance(float u, float v) const;
  };

  /// @param image 8-bit grey, at least 1 x 1; 255 reflects all light
  /// @param width, height of the texture, metres
  RoomTexture(const cv::Mat& image, double width, double height);
  /// The level that averages over about this footprint, metres.
  const Level& level(float footprint) const;

 private:
  std::vector<Level> levels_;
  float texel_;  // metres
};

// Inline because they are called for every ray.
inline const RoomTexture::Level& RoomTexture::level(float footprint) const {
  std::size_t i = 0;
  for (float texel = 2.0F * texel_; footprint > texel && i + 1 < levels_.size(); texel *= 2.0F) ++i;
  return levels_[i];
}

inline float RoomTexture::Level::reflectance(float u, float v) const {
  const int columns = image.cols;
  const float x = std::clamp(u * scale_u - 0.5F, 0.0F, static_cast<float>(columns - 1));
  const float y = std::clamp(v * scale_v - 0.5F, 0.0F, static_cast<float>(image.rows - 1));
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const int right = x0 + 1 < columns ? 1 : 0;
  const std::uint8_t* top = image.data + static_cast<std::ptrdiff_t>(y0) * columns + x0;
  const std::uint8_t* bottom = top + (y0 + 1 < image.rows ? columns : 0);
  const float a = x - static_cast<float>(x0);
  const float b = y - static_cast<float>(y0);
  const float upper = static_cast<float>(top[0]) + a * static_cast<float>(top[right] - top[0]);
  const float lower = static_cast<float>(bottom[0]) + a * static_cast<float>(bottom[right] - bottom[0]);
  return (upper + b * (lower - upper)) * (1.0F / 255.0F);
}

/// Paints a wall with plaster, skirting, a door, shelves, posters and cables: many kinds of edges that a
/// marker detector must reject. The same seed gives the same texture.
/// @param width, height metres, positive
RoomTexture paintWall(double width, double height, std::uint64_t seed);
/// Paints a floor of tiles.
RoomTexture paintFloor(double width, double height, std::uint64_t seed);
/// Paints a ceiling of panels with lamps.
RoomTexture paintCeiling(double width, double height, std::uint64_t seed);

}  // namespace sextant
