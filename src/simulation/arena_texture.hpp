// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace sextant {

/// An RGB image pyramid; the first level has kArenaTexels per metre.
using ArenaTexture = std::vector<cv::Mat_<cv::Vec3f>>;
constexpr double kArenaTexels = 100.0;

/// Draw a random reflectance of a floor, wall or ceiling. Sides in metres. @{
cv::Mat_<cv::Vec3f> arenaFloor(double width, double depth, cv::RNG& random);
cv::Mat_<cv::Vec3f> arenaWall(double width, double height, cv::RNG& random);
cv::Mat_<cv::Vec3f> arenaCeiling(double width, double depth, cv::RNG& random);
/// @}
/// Draws smudges and scratches, a square of 2 m: 0 on clean places, 1 on the darkest ones.
cv::Mat_<cv::Vec3f> arenaSmudges(cv::RNG& random);
/// Builds the pyramid of a texture.
ArenaTexture arenaPyramid(const cv::Mat_<cv::Vec3f>& texture);

/// Reflectance at u to the right and v down, metres. @param width footprint of the pixel, metres
Eigen::Vector3f arenaTexel(const ArenaTexture& texture, float u, float v, float width);

}  // namespace sextant
