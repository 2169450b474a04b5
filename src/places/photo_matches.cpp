// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/photo_matches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace sextant {
namespace {

// Compiled for both; the loader chooses (before a sanitizer is ready). NEON is part of every arm64.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SEXTANT_VECTORIZED __attribute__((target_clones("avx2", "default")))
#else
#define SEXTANT_VECTORIZED
#endif

using Words = Eigen::Matrix<int16_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Sums = Eigen::ArrayXi;

constexpr int32_t kNone = std::numeric_limits<int32_t>::max();

// Product of two codes: multiplications of eight or sixteen words at a time, without a loop if Width is
// known.
template <int Width>
inline __attribute__((always_inline)) int32_t product(const int16_t* a, const int16_t* b, int width) {
  const int count = Width ? Width : width;
  int32_t sum = 0;
  for (int k = 0; k < count; ++k) sum += a[k] * b[k];
  return sum;
}

template <int Width>
inline __attribute__((always_inline)) void distancesOf(const int16_t* code, int32_t square,
                                                       const int16_t* codes, const int32_t* squares,
                                                       int count, int width, int32_t* found) {
  for (int j = 0; j < count; ++j)
    found[j] = square - 2 * product<Width>(code, codes + static_cast<int64_t>(j) * width, width) + squares[j];
}

// Squared distances of a code from all codes of a photo: |a|^2 - 2 a b + |b|^2.
SEXTANT_VECTORIZED void squaredDistances(const int16_t* code, int32_t square, const int16_t* codes,
                                         const int32_t* squares, int count, int width, int32_t* found) {
  if (width == 32)
    distancesOf<32>(code, square, codes, squares, count, width, found);
  else if (width == 64)
    distancesOf<64>(code, square, codes, squares, count, width, found);
  else
    distancesOf<0>(code, square, codes, squares, count, width, found);
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

SEXTANT_VECTORIZED int32_t leastOf(const int32_t* distances, int count) {
  int32_t least = kNone;
  for (int j = 0; j < count; ++j) least = distances[j] < least ? distances[j] : least;
  return least;
}

// Removes the least distance.
Nearest nearestOf(int32_t* distances, int count) {
  Nearest nearest;
  nearest.first = leastOf(distances, count);
  if (nearest.first == kNone) return nearest;
  nearest.row = static_cast<int>(std::find(distances, distances + count, nearest.first) - distances);
  distances[nearest.row] = kNone;
  nearest.second = leastOf(distances, count);
  return nearest;
}

float rootOf(int32_t square) {
  return square == kNone ? std::numeric_limits<float>::infinity() : std::sqrt(static_cast<float>(square));
}

// Codes as words, and their squares.
struct Unpacked {
  explicit Unpacked(const CodedKeypoints& keypoints)
      : words(keypoints.codes.cast<int16_t>()),
        squares(keypoints.codes.cast<int32_t>().rowwise().squaredNorm()) {}
  Words words;
  Sums squares;
};

}  // namespace

void requireComparable(const CodedKeypoints& image, const CodedKeypoints& photo) {
  for (const CodedKeypoints* each : {&image, &photo})
    if (each->positions.rows() != each->codes.rows())
      throw std::invalid_argument(std::to_string(each->positions.rows()) + " keypoints have " +
                                  std::to_string(each->codes.rows()) + " codes");
  if (image.codes.cols() != photo.codes.cols())
    throw std::invalid_argument("codes of " + std::to_string(image.codes.cols()) +
                                " dimensions cannot be compared with codes of " +
                                std::to_string(photo.codes.cols()));
}

PhotoMatches matchPhoto(const CodedKeypoints& image, const CodedKeypoints& photo) {
  requireComparable(image, photo);
  const Unpacked here(image), there(photo);
  const auto count = static_cast<int>(photo.codes.rows()), dimensions = static_cast<int>(photo.codes.cols());
  const Eigen::Index size = image.codes.rows();
  PhotoMatches found{Eigen::ArrayXf(size), Eigen::ArrayXf(size), Eigen::ArrayXi(size), {}};
  Sums distances(count), least = Sums::Constant(count, kNone), keypoints = Sums::Constant(count, -1);
  for (int i = 0; i < size; ++i) {
    squaredDistances(here.words.row(i).data(), here.squares[i], there.words.data(), there.squares.data(),
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

}  // namespace sextant
