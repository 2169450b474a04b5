// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include "sextant/places/photo_matches.hpp"

namespace sextant {

// Keypoints of an image, with their memory.
struct Keypoints {
  CodedKeypoints::Positions positions;
  CodedKeypoints::Codes codes;

  CodedKeypoints view() const {
    return {Eigen::Map<const CodedKeypoints::Positions>(positions.data(), positions.rows(), 2),
            Eigen::Map<const CodedKeypoints::Codes>(codes.data(), codes.rows(), codes.cols())};
  }
};

// In the middle of the image, with codes of any value.
inline Keypoints randomKeypoints(int count, int dimensions, std::mt19937& random) {
  std::uniform_int_distribution<int> code(-128, 127), position(10000, 50000);
  Keypoints keypoints{CodedKeypoints::Positions(count, 2), CodedKeypoints::Codes(count, dimensions)};
  for (Eigen::Index i = 0; i < keypoints.positions.size(); ++i)
    keypoints.positions.data()[i] = static_cast<uint16_t>(position(random));
  for (Eigen::Index i = 0; i < keypoints.codes.size(); ++i)
    keypoints.codes.data()[i] = static_cast<int8_t>(code(random));
  return keypoints;
}

}  // namespace sextant
