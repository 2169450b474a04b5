// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arena_texture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

using Texture = cv::Mat_<cv::Vec3f>;

constexpr double kLargestSide = 2000.0;  // texels
constexpr int kScratches = 150;
constexpr int kSmallest = 4;  // texels; minimum side in a pyramid

Texture plain(double width, double height, const cv::Scalar& colour) {
  const double most = kLargestSide / kArenaTexels;
  const auto texels = [&](double side) {
    return std::max(1, static_cast<int>(std::lround(std::min(side, most) * kArenaTexels)));
  };
  return Texture(cv::Size(texels(width), texels(height)), cv::Vec3f(colour[0], colour[1], colour[2]));
}

cv::Scalar drawn(cv::RNG& random, double low, double high, double apart) {
  const double grey = random.uniform(low, high);
  return {grey + random.uniform(-apart, apart), grey + random.uniform(-apart, apart),
          grey + random.uniform(-apart, apart)};
}

/// Adds smooth noise with this wavelength.
void addClouds(Texture& texture, double metres, double sigma, cv::RNG& random) {
  const int step = std::max(1, static_cast<int>(metres * kArenaTexels));
  cv::Mat coarse(texture.rows / step + 2, texture.cols / step + 2, CV_32F), fine;
  random.fill(coarse, cv::RNG::NORMAL, 0.0, sigma);
  cv::resize(coarse, fine, texture.size(), 0, 0, cv::INTER_CUBIC);
  std::vector<cv::Mat> same(3, fine);
  cv::Mat all;
  cv::merge(same, all);
  cv::add(texture, all, texture);
}

void clamp(Texture& texture) {
  cv::max(texture, cv::Scalar::all(0.02), texture);
  cv::min(texture, cv::Scalar::all(0.98), texture);
}

/// Planks, tiles or a carpet.
void paintFloor(Texture& texture, cv::RNG& random) {
  const int kind = random.uniform(0, 3);
  const int wide = static_cast<int>(kArenaTexels * random.uniform(0.12, 0.6));
  const int longs = kind == 0 ? 8 * wide : wide;
  if (kind < 2)
    for (int row = 0, y = 0; y < texture.rows; ++row, y += wide)
      for (int x = -(row * 37 % 5) * longs / 5; x < texture.cols; x += longs) {
        const double change = random.gaussian(0.04);
        const cv::Rect plank = cv::Rect(x, y, longs - 1, wide - 1) & cv::Rect({}, texture.size());
        if (plank.area() > 0) texture(plank) += cv::Scalar::all(change);
        cv::rectangle(texture, cv::Rect(x, y, longs, wide), cv::Scalar::all(0.12), 1);
      }
}

/// Posters, a door, a cupboard: any colours, but less saturated than those of pillars.
void paintWall(Texture& texture, cv::RNG& random) {
  const int count = texture.cols / 150 + 1;
  for (int i = 0; i < count; ++i) {
    const int width = static_cast<int>(kArenaTexels * random.uniform(0.2, 1.0));
    const int height = static_cast<int>(kArenaTexels * random.uniform(0.2, 1.6));
    const cv::Rect box(random.uniform(0, std::max(1, texture.cols - width)),
                       random.uniform(0, std::max(1, texture.rows - height)), width, height);
    cv::rectangle(texture, box, drawn(random, 0.15, 0.8, 0.12), cv::FILLED);
    cv::rectangle(texture, box, cv::Scalar::all(random.uniform(0.05, 0.9)), 3);
  }
  const int skirting = static_cast<int>(0.08 * kArenaTexels);
  cv::rectangle(texture, cv::Rect(0, texture.rows - skirting, texture.cols, skirting),
                drawn(random, 0.1, 0.8, 0.03), cv::FILLED);
}

}  // namespace

Texture arenaFloor(double width, double depth, cv::RNG& random) {
  Texture floor = plain(width, depth, drawn(random, 0.25, 0.6, 0.08));
  paintFloor(floor, random);
  addClouds(floor, 0.8, 0.03, random);
  addClouds(floor, 0.02, 0.03, random);
  clamp(floor);
  return floor;
}

Texture arenaWall(double width, double height, cv::RNG& random) {
  Texture wall = plain(width, height, drawn(random, 0.45, 0.85, 0.05));
  paintWall(wall, random);
  addClouds(wall, 0.7, 0.03, random);
  addClouds(wall, 0.03, 0.01, random);
  clamp(wall);
  return wall;
}

Texture arenaCeiling(double width, double depth, cv::RNG& random) {
  Texture ceiling = plain(width, depth, drawn(random, 0.7, 0.9, 0.02));
  addClouds(ceiling, 1.0, 0.02, random);
  clamp(ceiling);
  return ceiling;
}

Texture arenaSmudges(cv::RNG& random) {
  constexpr double kSide = 2;  // metres
  Texture smudges = plain(kSide, kSide, cv::Scalar::all(0));
  addClouds(smudges, 0.15, 0.3, random);
  addClouds(smudges, 0.03, 0.2, random);
  const auto anywhere = [&] {
    return cv::Point(random.uniform(0, smudges.cols), random.uniform(0, smudges.rows));
  };
  for (int scratch = 0; scratch < kScratches; ++scratch) {
    const cv::Point from = anywhere(), off((anywhere() - anywhere()) / 8);
    cv::line(smudges, from, from + off, cv::Scalar::all(random.uniform(-0.6, 0.9)), 1, cv::LINE_AA);
  }
  cv::max(smudges, cv::Scalar::all(0), smudges);
  cv::min(smudges, cv::Scalar::all(1), smudges);
  return smudges;
}

ArenaTexture arenaPyramid(const Texture& texture) {
  ArenaTexture pyramid{texture};
  while (std::min(pyramid.back().rows, pyramid.back().cols) > 2 * kSmallest) {
    cv::Mat smaller;
    cv::resize(pyramid.back(), smaller, {}, 0.5, 0.5, cv::INTER_AREA);
    pyramid.emplace_back(smaller);
  }
  return pyramid;
}

Eigen::Vector3f arenaTexel(const ArenaTexture& texture, float u, float v, float width) {
  const auto texels = static_cast<float>(kArenaTexels);
  const int wanted = width * texels > 1 ? static_cast<int>(std::log2(width * texels)) : 0;
  const auto level = static_cast<size_t>(std::clamp(wanted, 0, static_cast<int>(texture.size()) - 1));
  const Texture& image = texture[level];
  const float scale = texels / static_cast<float>(1U << level);
  // The texture is repeated on a surface that is larger; its copies have the same size at every level.
  const float x = std::max(0.F, std::fmod(u, static_cast<float>(texture[0].cols) / texels) * scale - 0.5F),
              y = std::max(0.F, std::fmod(v, static_cast<float>(texture[0].rows) / texels) * scale - 0.5F);
  const int left = std::clamp(static_cast<int>(x), 0, image.cols - 1),
            top = std::clamp(static_cast<int>(y), 0, image.rows - 1),
            right = std::min(left + 1, image.cols - 1), bottom = std::min(top + 1, image.rows - 1);
  const float a = x - static_cast<float>(left), b = y - static_cast<float>(top);
  const cv::Vec3f found = (1 - b) * ((1 - a) * image(top, left) + a * image(top, right)) +
                          b * ((1 - a) * image(bottom, left) + a * image(bottom, right));
  return {found[0], found[1], found[2]};
}

}  // namespace sextant
