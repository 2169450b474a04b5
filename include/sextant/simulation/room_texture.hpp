// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace sextant {

/// A picture on a plane, ready to be looked at from any distance (mip map; Williams 1983, "Pyramidal
/// parametrics").
class RoomTexture {
 public:
  /// The picture as it is seen from one distance.
  struct Level {
    cv::Mat_<std::uint8_t> picture;  // continuous
    float scale_u;                   // texels per metre
    float scale_v;

    /// Reflectance, [0, 1], at u metres right of and v metres below the top left corner; beyond the border it
    /// is that of the border.
    float reflectance(float u, float v) const;
  };

  /// @param picture 8-bit grey, at least 1 x 1; 255 reflects all light
  /// @param width, height of the picture in metres
  RoomTexture(const cv::Mat& picture, double width, double height);

  /// The picture averaged over about `footprint` metres.
  const Level& level(float footprint) const;

 private:
  std::vector<Level> levels_;
  float texel_;  // metres
};

// Inline because every ray asks for these.
inline const RoomTexture::Level& RoomTexture::level(float footprint) const {
  std::size_t i = 0;
  for (float texel = 2.0F * texel_; footprint > texel && i + 1 < levels_.size(); texel *= 2.0F) ++i;
  return levels_[i];
}

inline float RoomTexture::Level::reflectance(float u, float v) const {
  const int columns = picture.cols;
  const float x = std::clamp(u * scale_u - 0.5F, 0.0F, static_cast<float>(columns - 1));
  const float y = std::clamp(v * scale_v - 0.5F, 0.0F, static_cast<float>(picture.rows - 1));
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const int right = x0 + 1 < columns ? 1 : 0;
  const std::uint8_t* top = picture.data + static_cast<std::ptrdiff_t>(y0) * columns + x0;
  const std::uint8_t* bottom = top + (y0 + 1 < picture.rows ? columns : 0);
  const float a = x - static_cast<float>(x0);
  const float b = y - static_cast<float>(y0);
  const float upper = static_cast<float>(top[0]) + a * static_cast<float>(top[right] - top[0]);
  const float lower = static_cast<float>(bottom[0]) + a * static_cast<float>(bottom[right] - bottom[0]);
  return (upper + b * (lower - upper)) * (1.0F / 255.0F);
}

/// A wall with plaster, skirting, a door, shelves, posters and cables: edges of every kind for a marker
/// detector to reject. The same seed gives the same picture.
/// @param width, height in metres, positive
RoomTexture paintWall(double width, double height, std::uint64_t seed);
/// A floor of tiles.
RoomTexture paintFloor(double width, double height, std::uint64_t seed);
/// A ceiling of panels with lamps.
RoomTexture paintCeiling(double width, double height, std::uint64_t seed);

}  // namespace sextant
