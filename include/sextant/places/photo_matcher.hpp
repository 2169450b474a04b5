// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace sextant {

/// Keypoints of one image, with short codes of their descriptors.
struct CodedKeypoints {
  using Places = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  using Codes = Eigen::Matrix<int8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Places places;  ///< x, y and size of each, as fractions of the image's longer side
  Codes codes;    ///< one row per keypoint
};

/// The most similar keypoint of one photo for each of the n keypoints of an image.
struct PhotoMatches {
  Eigen::ArrayXf distances;  ///< (n) Euclidean distance of the codes; infinite if the photo has no keypoint
  Eigen::ArrayXf seconds;    ///< (n) distance of the second most similar; infinite if there is none
  Eigen::ArrayXi rows;       ///< (n) keypoint of the photo; -1 if it has none
  Eigen::Array<bool, Eigen::Dynamic, 1> mutual;  ///< (n) whether none of the image is more similar to it
};

/// Photos with their coded keypoints, with each of which an image is compared. For up to about a thousand
/// photos this takes some ten milliseconds, and finds more than the nearest neighbours among the keypoints of
/// all photos: there, photos with many keypoints take those of the right one. Matching is thread-safe.
class PhotoMatcher {
 public:
  /// @param dimensions of the codes, at least 1
  /// @throws std::invalid_argument for fewer
  explicit PhotoMatcher(int dimensions);

  /// Adds a photo after the others.
  /// @throws std::invalid_argument if codes and places differ in number, or the codes have other dimensions
  void add(const CodedKeypoints& photo);
  /// Removes the photo with this number; those after it get a number less.
  /// @throws std::out_of_range if there is none
  void remove(int photo);

  int size() const { return static_cast<int>(photos_.size()); }  ///< number of photos
  int64_t bytes() const;                                         ///< memory of codes and places
  /// The keypoints of a photo. @throws std::out_of_range if there is none
  const CodedKeypoints& photo(int number) const { return photos_.at(number); }

  /// Compares an image with each photo, in their order.
  /// @throws std::invalid_argument as add()
  std::vector<PhotoMatches> match(const CodedKeypoints& image) const;

 private:
  void check(const CodedKeypoints& image) const;

  int dimensions_;
  std::vector<CodedKeypoints> photos_;
};

}  // namespace sextant
