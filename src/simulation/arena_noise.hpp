// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace sextant {

/// A random generator whose numbers are independent for successive seeds, unlike cv::RNG's first ones.
cv::RNG arenaRandom(std::uint64_t seed);

/// A table of standard normal numbers, from which a camera takes the noise of each image at another offset.
std::vector<float> arenaNoise(int seed, int count);

/// Offset of a frame's noise in a table of this length.
std::size_t arenaNoiseAt(std::uint64_t frame, std::size_t count);

}  // namespace sextant
