// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/photo_scores.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

// Cells of the histograms, as fractions of the longer side: displacements depend on the depth of the scene.
constexpr float kCells[] = {0.1F, 0.2F, 0.45F};
constexpr float kReach = 1.6F;      // maximum displacement, as a fraction of the longer side
constexpr float kNoMatches = 1e-3F;  // added to scores before the logarithm

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

// Weight of each match: 1 for equal codes, 0 from the background distance on.
Eigen::ArrayXf weightsOf(const PhotoMatches& matches, const Eigen::ArrayXf& background) {
  const Eigen::ArrayXf least = background.max(std::numeric_limits<float>::min());
  return (matches.rows >= 0).select((1 - matches.distances / least).max(0), 0);
}

float highestCells(const CodedKeypoints& image, const CodedKeypoints& photo, const PhotoMatches& matches,
                   const Eigen::ArrayXf& weights) {
  float sum = 0;
  for (const float cell : kCells) {
    DisplacementHistogram histogram(cell);
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      if (!matches.mutual[i] || weights[i] <= 0) continue;
      const auto there = photo.places.row(matches.rows[i]), here = image.places.row(i);
      histogram.add(there[0] - here[0], there[1] - here[1], weights[i]);
    }
    sum += histogram.highest();
  }
  return sum;
}

}  // namespace

Eigen::ArrayXf PhotoScores::logarithms() const {
  return (distinctive + kNoMatches).log() + (consistent + kNoMatches).log();
}

Eigen::ArrayXf backgroundDistances(const std::vector<PhotoMatches>& matches, int k) {
  if (matches.empty()) return {};
  const Eigen::Index size = matches[0].distances.size();
  const auto nth = static_cast<std::ptrdiff_t>(std::min<size_t>(k, matches.size())) - 1;
  Eigen::ArrayXf background(size);
  std::vector<float> distances(matches.size());
  for (Eigen::Index i = 0; i < size; ++i) {
    std::transform(matches.begin(), matches.end(), distances.begin(),
                   [i](const PhotoMatches& photo) { return photo.distances[i]; });
    std::nth_element(distances.begin(), distances.begin() + nth, distances.end());
    background[i] = distances[static_cast<size_t>(nth)];
  }
  return background;
}

PhotoScores photoScores(const CodedKeypoints& image, const PhotoMatcher& photos,
                        const std::vector<PhotoMatches>& matches, const Eigen::ArrayXf& background) {
  PhotoScores scores{Eigen::ArrayXf(matches.size()), Eigen::ArrayXf(matches.size())};
  for (size_t p = 0; p < matches.size(); ++p) {
    const CodedKeypoints& photo = photos.photo(static_cast<int>(p));
    const Eigen::ArrayXf weights = weightsOf(matches[p], background);
    const double product = static_cast<double>(image.places.rows()) * static_cast<double>(photo.places.rows());
    const auto mean = static_cast<float>(std::sqrt(std::max(product, 1.0)));
    const auto number = static_cast<Eigen::Index>(p);
    scores.distinctive[number] = weights.sum() / mean;
    scores.consistent[number] = highestCells(image, photo, matches[p], weights) / mean;
  }
  return scores;
}

}  // namespace sextant
