// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/places/photo_matcher.hpp"

namespace sextant {

/// Scores of the photos of a map against one image, each (photos); larger is better. Both are sums of
/// weights of matches over the geometric mean of the numbers of keypoints.
struct PhotoScores {
  /// Of all matches: local naive Bayes nearest neighbour (McCann and Lowe, CVPR 2012).
  Eigen::ArrayXf distinctive;
  /// Of mutual matches with about the same displacement in the image: the highest cells of three histograms.
  Eigen::ArrayXf consistent;

  /// The logarithm of their product.
  Eigen::ArrayXf logarithms() const;
};

/// Distance (n) of each keypoint of an image from the background: to the k-th nearest of the photos, each
/// with its most similar keypoint.
/// @param matches with the photos of the map and, if they are few, with other photos
/// @param k at least 1; with fewer photos, the farthest
Eigen::ArrayXf backgroundDistances(const std::vector<PhotoMatches>& matches, int k);

/// Scores all photos.
/// @param matches of the image with each photo
/// @param background (n) distances, see backgroundDistances()
PhotoScores photoScores(const CodedKeypoints& image, const PhotoMatcher& photos,
                        const std::vector<PhotoMatches>& matches, const Eigen::ArrayXf& background);

}  // namespace sextant
