// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace sextant {

/// Views of the keypoints of one image and of short codes of their descriptors.
struct CodedKeypoints {
  /// Two columns.
  using Positions = Eigen::Matrix<uint16_t, Eigen::Dynamic, 2, Eigen::RowMajor>;
  /// One column for each component.
  using Codes = Eigen::Matrix<int8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static constexpr int kUnit = 65535;  ///< position that corresponds to the image's longer side

  Eigen::Map<const Positions> positions;  ///< x, y of each keypoint, in units of the longer side / kUnit
  Eigen::Map<const Codes> codes;          ///< one row per keypoint
};

/// The most similar keypoint of a photo for each of the n keypoints of an image.
struct PhotoMatches {
  Eigen::ArrayXf distances;  ///< (n) Euclidean distance of the codes; infinite if the photo has no keypoint
  Eigen::ArrayXf seconds;    ///< (n) distance of the second most similar; infinite if there is none
  Eigen::ArrayXi rows;       ///< (n) keypoint of the photo; -1 if it has none
  Eigen::Array<bool, Eigen::Dynamic, 1> mutual;  ///< (n) whether none of the image is more similar to it
};

/// @throws std::invalid_argument if positions and codes differ in number, or codes in width
void requireComparable(const CodedKeypoints& image, const CodedKeypoints& photo);

/// Compares each keypoint of an image with each of a photo.
/// @throws std::invalid_argument see requireComparable()
PhotoMatches matchPhoto(const CodedKeypoints& image, const CodedKeypoints& photo);

}  // namespace sextant
