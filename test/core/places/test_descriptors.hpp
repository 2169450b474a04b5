// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "sextant/places/descriptor_index.hpp"

namespace sextant {

/// Synthetic descriptors in a subspace, as those of images are; or random bits.
inline cv::Mat randomDescriptors(int rows, int width, int type, int seed) {
  cv::RNG random(seed);
  cv::Mat all(rows, width, type);
  if (type == CV_8U) {
    random.fill(all, cv::RNG::UNIFORM, 0, 256);
    return all;
  }
  cv::Mat basis(16, width, CV_32F), parts(rows, 16, CV_32F);
  cv::RNG(99).fill(basis, cv::RNG::NORMAL, 0, 1);
  random.fill(parts, cv::RNG::NORMAL, 0, 30);
  return parts * basis;
}

using Descriptors = std::map<int32_t, cv::Mat>;

/// Images with various numbers of descriptors, including one.
inline Descriptors imageDescriptors(int count, int width, int type) {
  Descriptors all;
  for (int i = 0; i < count; ++i) all[i] = randomDescriptors(1 + 37 * i % 90, width, type, i);
  return all;
}

inline cv::Mat together(const Descriptors& all) {
  cv::Mat matrix;
  for (const auto& [image_id, descriptors] : all) matrix.push_back(descriptors);
  return matrix;
}

inline std::unique_ptr<DescriptorIndex> indexOf(const std::string& matcher, const Descriptors& all) {
  const cv::Mat samples = together(all);
  auto index = makeDescriptorIndex(matcher, samples, samples.rows);
  for (const auto& [image_id, descriptors] : all) index->add(image_id, descriptors);
  return index;
}

/// A matcher and descriptors of its type.
struct MatcherCase {
  std::string matcher;
  int type, width;
};

inline const std::vector<MatcherCase>& matcherCases() {
  static const std::vector<MatcherCase> all = {
      {"faiss", CV_32F, 64},
      {"faiss", CV_32F, 128},
      {"faiss", CV_8U, 32},
      {"FlannBased", CV_32F, 64},
      {"BruteForce", CV_32F, 128},
      {"BruteForce-L1", CV_32F, 64},
      {"BruteForce-Hamming", CV_8U, 61},
      {"BruteForce-Hamming(2)", CV_8U, 32},
  };
  return all;
}

inline void expectSame(const Neighbours& a, const Neighbours& b) {
  EXPECT_EQ(a.k, b.k);
  EXPECT_EQ(a.distances, b.distances);
  EXPECT_EQ(a.image_ids, b.image_ids);
  EXPECT_EQ(a.rows, b.rows);
}

/// Every ninth descriptor with noise.
inline cv::Mat similarTo(const Descriptors& all) {
  cv::Mat queries, picked = together(all);
  for (int row = 0; row < picked.rows; row += 9) queries.push_back(picked.row(row));
  if (queries.type() == CV_32F)
    return queries + 0.1 * randomDescriptors(queries.rows, queries.cols, CV_32F, 1000);
  for (int row = 0; row < queries.rows; ++row)
    for (int i = 0; i < 5; ++i) queries.at<uchar>(row, (7 * row + 11 * i) % queries.cols) ^= 1 << i;
  return queries;
}

}  // namespace sextant
