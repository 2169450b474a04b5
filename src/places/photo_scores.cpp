// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/photo_scores.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core/utility.hpp>

namespace sextant {
namespace {

// Cells of the histograms, as fractions of the longer side: displacements depend on the depth of the scene.
constexpr float kCells[] = {0.05F, 0.1F, 0.2F, 0.45F};
constexpr float kReach = 1.6F;  // half the side of a histogram, likewise

// Weights by displacement, each shared by the four nearest cells.
class DisplacementHistogram {
 public:
  explicit DisplacementHistogram(float cell)
      : cell_(cell), cells_(Eigen::ArrayXXf::Zero(cellsAlong(cell), cellsAlong(cell))) {}

  void add(float dx, float dy, float weight) {
    const float x = position(dx), y = position(dy);
    const auto left = static_cast<Eigen::Index>(x), top = static_cast<Eigen::Index>(y);
    const float right_share = x - static_cast<float>(left), low_share = y - static_cast<float>(top);
    cells_(top, left) += weight * (1 - right_share) * (1 - low_share);
    cells_(top, left + 1) += weight * right_share * (1 - low_share);
    cells_(top + 1, left) += weight * (1 - right_share) * low_share;
    cells_(top + 1, left + 1) += weight * right_share * low_share;
  }

  float highest() const { return cells_.maxCoeff(); }

 private:
  static Eigen::Index cellsAlong(float cell) {
    return static_cast<Eigen::Index>(std::ceil(2 * kReach / cell)) + 2;
  }

  float position(float displacement) const {
    return std::clamp((displacement + kReach) / cell_, 0.0F, static_cast<float>(cells_.rows() - 2));
  }

  float cell_;
  Eigen::ArrayXXf cells_;
};

// Weight of each match: 1 for equal codes, 0 from the background distance on, or if it is not mutual.
Eigen::ArrayXf weightsOf(const PhotoMatches& matches, const Eigen::ArrayXf& background) {
  const Eigen::ArrayXf least = background.max(std::numeric_limits<float>::min());
  return matches.mutual.select((1 - matches.distances / least).max(0), 0);
}

float highestCells(const CodedKeypoints& image, const CodedKeypoints& photo, const PhotoMatches& matches,
                   const Eigen::ArrayXf& weights) {
  float sum = 0;
  for (const float cell : kCells) {
    DisplacementHistogram histogram(cell);
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      if (weights[i] <= 0) continue;
      const auto there = photo.positions.row(matches.rows[i]), here = image.positions.row(i);
      const Eigen::Array2f displacement =
          (there.cast<float>() - here.cast<float>()).array() / CodedKeypoints::kUnit;
      histogram.add(displacement.x(), displacement.y(), weights[i]);
    }
    sum += histogram.highest();
  }
  return sum;
}

// Distance of each keypoint of an image from those of the photos that it does not match, see scorePhotos().
Eigen::ArrayXf backgroundDistances(const std::vector<PhotoMatches>& matches, Eigen::Index size, int k) {
  Eigen::ArrayXf background = Eigen::ArrayXf::Zero(size);
  std::vector<float> distances;
  for (Eigen::Index i = 0; i < size; ++i) {
    distances.clear();
    for (const PhotoMatches& photo : matches)
      for (const float distance : {photo.distances[i], photo.seconds[i]})
        if (std::isfinite(distance)) distances.push_back(distance);
    if (distances.empty()) continue;
    const auto kth =
        distances.begin() + static_cast<std::ptrdiff_t>(std::min<size_t>(k, distances.size())) - 1;
    std::nth_element(distances.begin(), kth, distances.end());
    background[i] = *kth;
  }
  return background;
}

}  // namespace

PhotoScores scorePhotos(const CodedKeypoints& image, const std::vector<CodedKeypoints>& photos, int k) {
  const auto count = static_cast<Eigen::Index>(photos.size());
  const Eigen::Index size = image.codes.rows();
  for (const CodedKeypoints& photo : photos) requireComparable(image, photo);
  std::vector<PhotoMatches> matches(photos.size());
  cv::parallel_for_({0, static_cast<int>(count)}, [&](const cv::Range& range) {
    for (int p = range.start; p < range.end; ++p) matches[p] = matchPhoto(image, photos[p]);
  });
  PhotoScores scores{Eigen::ArrayXf(count), Eigen::ArrayXf(count), backgroundDistances(matches, size, k),
                     Eigen::ArrayXf::Constant(size, std::numeric_limits<float>::infinity())};
  for (Eigen::Index p = 0; p < count; ++p) {
    const CodedKeypoints& photo = photos[p];
    const Eigen::ArrayXf weights = weightsOf(matches[p], scores.background);
    const double product = static_cast<double>(size) * static_cast<double>(photo.codes.rows());
    const auto mean = static_cast<float>(std::sqrt(std::max(product, 1.0)));
    scores.distinctive[p] = weights.sum() / mean;
    scores.consistent[p] = highestCells(image, photo, matches[p], weights) / mean;
    scores.nearest = scores.nearest.min(matches[p].distances);
  }
  return scores;
}

}  // namespace sextant
