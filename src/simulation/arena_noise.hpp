// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace sextant {

/// Numbers that have nothing in common with those of the next seed: cv::RNG's first ones have.
cv::RNG arenaRandom(std::uint64_t seed);

/// Standard normal numbers: drawn once, for a camera that begins each picture elsewhere in them.
std::vector<float> arenaNoise(int seed, int count);

/// Where in so many numbers a frame's noise begins.
std::size_t arenaNoiseAt(std::uint64_t frame, std::size_t count);

}  // namespace sextant
