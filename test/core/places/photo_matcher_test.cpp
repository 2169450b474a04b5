// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/photo_matcher.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>

namespace sextant {
namespace {

constexpr int kDimensions = 20;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

CodedKeypoints randomKeypoints(int count, unsigned seed, int dimensions = kDimensions) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> code(-127, 127);
  CodedKeypoints keypoints{CodedKeypoints::Places::Constant(count, 3, 0.5F),
                           CodedKeypoints::Codes(count, dimensions)};
  for (Eigen::Index i = 0; i < keypoints.codes.size(); ++i)
    keypoints.codes.data()[i] = static_cast<int8_t>(code(random));
  return keypoints;
}

// In double precision, by definition.
Eigen::MatrixXd distancesOf(const CodedKeypoints& a, const CodedKeypoints& b) {
  Eigen::MatrixXd distances(a.codes.rows(), b.codes.rows());
  for (Eigen::Index i = 0; i < distances.rows(); ++i)
    for (Eigen::Index j = 0; j < distances.cols(); ++j)
      distances(i, j) = (a.codes.row(i).cast<double>() - b.codes.row(j).cast<double>()).norm();
  return distances;
}

TEST(PhotoMatcher, FindsTheTwoMostSimilarKeypointsOfEachPhoto) {
  PhotoMatcher matcher(kDimensions);
  const CodedKeypoints image = randomKeypoints(31, 1);
  for (const int count : {57, 2, 1}) matcher.add(randomKeypoints(count, 100 + count));
  const auto matches = matcher.match(image);
  ASSERT_EQ(matches.size(), 3u);
  for (int p = 0; p < 3; ++p) {
    Eigen::MatrixXd distances = distancesOf(image, matcher.photo(p));
    for (Eigen::Index i = 0; i < distances.rows(); ++i) {
      Eigen::Index nearest, back;
      EXPECT_NEAR(matches[p].distances[i], distances.row(i).minCoeff(&nearest), 1e-3);
      EXPECT_EQ(matches[p].rows[i], nearest);
      distances.col(nearest).minCoeff(&back);
      EXPECT_EQ(matches[p].mutual[i], back == i);
      Eigen::RowVectorXd others = distances.row(i);
      others[nearest] = kInfinite;
      const double second = others.minCoeff();
      if (p == 2)
        EXPECT_EQ(matches[p].seconds[i], kInfinite);
      else
        EXPECT_NEAR(matches[p].seconds[i], second, 1e-3);
    }
  }
}

TEST(PhotoMatcher, AnImageOrAPhotoMayHaveNoKeypoint) {
  PhotoMatcher matcher(kDimensions);
  EXPECT_TRUE(matcher.match(randomKeypoints(3, 1)).empty());
  matcher.add(randomKeypoints(0, 2));
  const auto matches = matcher.match(randomKeypoints(3, 1));
  ASSERT_EQ(matches.size(), 1u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(matches[0].distances[i], kInfinite);
    EXPECT_EQ(matches[0].rows[i], -1);
    EXPECT_FALSE(matches[0].mutual[i]);
  }
  EXPECT_EQ(matcher.match(randomKeypoints(0, 1))[0].distances.size(), 0);
}

TEST(PhotoMatcher, ForgetsARemovedPhoto) {
  PhotoMatcher matcher(kDimensions);
  for (const unsigned seed : {1U, 2U, 3U}) matcher.add(randomKeypoints(5, seed));
  const int64_t bytes = matcher.bytes();
  matcher.remove(1);
  EXPECT_EQ(matcher.size(), 2);
  EXPECT_EQ(3 * matcher.bytes(), 2 * bytes);
  EXPECT_EQ(matcher.photo(1).codes, randomKeypoints(5, 3).codes);
  EXPECT_THROW(matcher.remove(2), std::out_of_range);
}

TEST(PhotoMatcher, RefusesOtherCodes) {
  EXPECT_THROW(PhotoMatcher(0), std::invalid_argument);
  PhotoMatcher matcher(kDimensions);
  EXPECT_THROW(matcher.add(randomKeypoints(2, 1, kDimensions + 1)), std::invalid_argument);
  EXPECT_THROW(matcher.match(randomKeypoints(2, 1, kDimensions - 1)), std::invalid_argument);
  CodedKeypoints keypoints = randomKeypoints(2, 1);
  keypoints.places.resize(1, 3);
  EXPECT_THROW(matcher.add(keypoints), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
