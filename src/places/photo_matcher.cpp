// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/photo_matcher.hpp"

#include <limits>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <string>

namespace sextant {
namespace {

// Compiled for both; the loader chooses. ARM's NEON is part of every arm64.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define SEXTANT_VECTORIZED __attribute__((target_clones("avx2", "default")))
#else
#define SEXTANT_VECTORIZED
#endif

using Words = Eigen::Matrix<int16_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Sums = Eigen::ArrayXi;

constexpr int32_t kNone = std::numeric_limits<int32_t>::max();

// Squared distances of a code from all codes of a photo: |a|^2 - 2 a b + |b|^2. A loop of this kind becomes
// multiplications of eight or sixteen words at a time.
SEXTANT_VECTORIZED void squaredDistances(const int16_t* code, int32_t square, const int16_t* codes,
                                         const int32_t* squares, int count, int dimensions, int32_t* found) {
  for (int j = 0; j < count; ++j) {
    const int16_t* other = codes + static_cast<int64_t>(j) * dimensions;
    int32_t product = 0;
    for (int k = 0; k < dimensions; ++k) product += code[k] * other[k];
    found[j] = square - 2 * product + squares[j];
  }
}

// Where it is less than the least so far, it becomes the least of image keypoint i.
SEXTANT_VECTORIZED void keepLeast(const int32_t* distances, int count, int32_t i, int32_t* least,
                                  int32_t* keypoints) {
  for (int j = 0; j < count; ++j) {
    const bool is_less = distances[j] < least[j];
    least[j] = is_less ? distances[j] : least[j];
    keypoints[j] = is_less ? i : keypoints[j];
  }
}

struct Nearest {
  int32_t first = kNone, second = kNone;
  int row = -1;
};

Nearest nearestOf(const int32_t* distances, int count) {
  Nearest nearest;
  for (int j = 0; j < count; ++j) {
    if (distances[j] < nearest.first) {
      nearest.second = nearest.first;
      nearest.first = distances[j];
      nearest.row = j;
    } else if (distances[j] < nearest.second) {
      nearest.second = distances[j];
    }
  }
  return nearest;
}

float rootOf(int32_t square) {
  return square == kNone ? std::numeric_limits<float>::infinity() : std::sqrt(static_cast<float>(square));
}

// Codes of an image as words, and their squares.
struct Unpacked {
  explicit Unpacked(const CodedKeypoints::Codes& codes)
      : words(codes.cast<int16_t>()), squares(codes.cast<int32_t>().rowwise().squaredNorm()) {}
  Words words;
  Sums squares;
};

PhotoMatches matchesOf(const Unpacked& image, const CodedKeypoints::Codes& codes) {
  const Unpacked photo(codes);
  const auto count = static_cast<int>(codes.rows()), dimensions = static_cast<int>(codes.cols());
  const Eigen::Index size = image.squares.size();
  PhotoMatches found{Eigen::ArrayXf(size), Eigen::ArrayXf(size), Eigen::ArrayXi(size), {}};
  Sums distances(count), least = Sums::Constant(count, kNone), keypoints = Sums::Constant(count, -1);
  for (int i = 0; i < size; ++i) {
    squaredDistances(image.words.row(i).data(), image.squares[i], photo.words.data(), photo.squares.data(),
                     count, dimensions, distances.data());
    keepLeast(distances.data(), count, i, least.data(), keypoints.data());
    const Nearest nearest = nearestOf(distances.data(), count);
    found.distances[i] = rootOf(nearest.first);
    found.seconds[i] = rootOf(nearest.second);
    found.rows[i] = nearest.row;
  }
  found.mutual.resize(size);
  for (int i = 0; i < size; ++i) found.mutual[i] = found.rows[i] >= 0 && keypoints[found.rows[i]] == i;
  return found;
}

}  // namespace

PhotoMatcher::PhotoMatcher(int dimensions) : dimensions_(dimensions) {
  if (dimensions < 1)
    throw std::invalid_argument("codes have " + std::to_string(dimensions) + " dimensions, at least 1");
}

void PhotoMatcher::add(const CodedKeypoints& photo) {
  check(photo);
  photos_.push_back(photo);
}

void PhotoMatcher::remove(int photo) {
  photos_.at(photo);
  photos_.erase(photos_.begin() + photo);
}

int64_t PhotoMatcher::bytes() const {
  int64_t bytes = 0;
  for (const CodedKeypoints& photo : photos_)
    bytes += photo.codes.size() + photo.places.size() * static_cast<int64_t>(sizeof(float));
  return bytes;
}

std::vector<PhotoMatches> PhotoMatcher::match(const CodedKeypoints& image) const {
  check(image);
  const Unpacked unpacked(image.codes);
  std::vector<PhotoMatches> matches(photos_.size());
  cv::parallel_for_({0, size()}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) matches[i] = matchesOf(unpacked, photos_[i].codes);
  });
  return matches;
}

void PhotoMatcher::check(const CodedKeypoints& image) const {
  if (image.places.rows() != image.codes.rows() || image.codes.cols() != dimensions_)
    throw std::invalid_argument(std::to_string(image.places.rows()) + " keypoints have " +
                                std::to_string(image.codes.rows()) + " codes of " +
                                std::to_string(image.codes.cols()) + " dimensions, not of " +
                                std::to_string(dimensions_));
}

}  // namespace sextant
