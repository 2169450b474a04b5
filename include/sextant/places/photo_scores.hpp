// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/places/photo_matches.hpp"

namespace sextant {

/// Scores of m photos for one image with n keypoints. They are sums of weights of mutual matches over the
/// geometric mean of the numbers of keypoints; larger is better. The weight of a match is 1 for equal codes,
/// and 0 from the background distance on: local naive Bayes nearest neighbour (McCann and Lowe, CVPR 2012).
struct PhotoScores {
  Eigen::ArrayXf distinctive;  ///< (m) of all of them; 1 if all codes are equal
  Eigen::ArrayXf consistent;   ///< (m) of those with about the same displacement: the sum of the highest
                               ///< cells of four histograms of displacements
  Eigen::ArrayXf background;   ///< (n) distance of a keypoint of the photos that does not match
  Eigen::ArrayXf nearest;      ///< (n) distance of the most similar keypoint of all photos
};

/// Compares an image with each photo. For up to about a thousand photos this takes some ten milliseconds, and
/// recognizes more than votes of nearest neighbours among the keypoints of all photos, most of which are
/// those of photos with many keypoints.
/// @param k at least 1: the background distance of a keypoint is the k-th smallest among the distances of
/// the most similar and second most similar keypoints of all photos; with fewer of them, the largest
/// @throws std::invalid_argument see requireComparable()
PhotoScores scorePhotos(const CodedKeypoints& image, const std::vector<CodedKeypoints>& photos, int k);

}  // namespace sextant
