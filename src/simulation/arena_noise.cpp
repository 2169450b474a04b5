// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "arena_noise.hpp"

namespace sextant {

/// The state comes from SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number
/// generators").
cv::RNG arenaRandom(std::uint64_t seed) {
  std::uint64_t z = (seed + 1) * 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return cv::RNG(z ^ (z >> 31U));
}

std::vector<float> arenaNoise(int seed, int count) {
  std::vector<float> numbers(static_cast<size_t>(count));
  cv::Mat all(1, count, CV_32F, numbers.data());
  cv::RNG random = arenaRandom(static_cast<std::uint64_t>(seed));
  random.fill(all, cv::RNG::NORMAL, 0.0, 1.0);
  return numbers;
}

std::size_t arenaNoiseAt(std::uint64_t frame, std::size_t count) {
  return static_cast<std::size_t>((frame * 0x9E3779B97F4A7C15ULL) >> 40U) % count;  // Knuth's hash
}

}  // namespace sextant
