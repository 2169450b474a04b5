// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace sextant {

/// Pictures of red, green and blue, each half as large as the one before; kArenaTexels of the first are a
/// metre.
using ArenaTexture = std::vector<cv::Mat_<cv::Vec3f>>;
constexpr double kArenaTexels = 100.0;

/// Reflectance of floor, walls and ceiling, drawn anew each time. Sides in metres. @{
cv::Mat_<cv::Vec3f> arenaFloor(double width, double depth, cv::RNG& random);
cv::Mat_<cv::Vec3f> arenaWall(double width, double height, cv::RNG& random);
cv::Mat_<cv::Vec3f> arenaCeiling(double width, double depth, cv::RNG& random);
/// @}
ArenaTexture arenaPyramid(const cv::Mat_<cv::Vec3f>& picture);

/// At u to the right and v down, metres. @param width of what a pixel sees, metres
Eigen::Vector3f arenaTexel(const ArenaTexture& texture, float u, float v, float width);

}  // namespace sextant
