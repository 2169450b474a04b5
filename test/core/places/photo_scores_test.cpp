// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/photo_scores.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sextant {
namespace {

constexpr int kDimensions = 32;

CodedKeypoints randomKeypoints(int count, std::mt19937& random) {
  std::uniform_int_distribution<int> code(-60, 60);
  std::uniform_real_distribution<float> place(0.1F, 0.9F);
  CodedKeypoints keypoints{CodedKeypoints::Places(count, 3), CodedKeypoints::Codes(count, kDimensions)};
  for (int i = 0; i < count; ++i) keypoints.places.row(i) << place(random), 0.7F * place(random), 0.02F;
  for (Eigen::Index i = 0; i < keypoints.codes.size(); ++i)
    keypoints.codes.data()[i] = static_cast<int8_t>(code(random));
  return keypoints;
}

class Scores : public testing::Test {
 protected:
  Scores() {
    for (int p = 0; p < 6; ++p) photos_.add(randomKeypoints(80, random_));
  }

  PhotoScores scores(const CodedKeypoints& image) const {
    const auto matches = photos_.match(image);
    return photoScores(image, photos_, matches, backgroundDistances(matches, 4));
  }

  std::mt19937 random_{7};
  PhotoMatcher photos_{kDimensions};
};

TEST_F(Scores, OfAPhotoItselfAreThoseOfEqualCodes) {
  const PhotoScores found = scores(photos_.photo(2));
  EXPECT_NEAR(found.distinctive[2], 1, 1e-6);
  // The displacement 0 is in the middle of a cell of .1 and .2, and 4/9 of a cell of .45 away from it.
  EXPECT_NEAR(found.consistent[2], 2 + 25.0 / 81, 1e-3);
  Eigen::Index best;
  found.logarithms().maxCoeff(&best);
  EXPECT_EQ(best, 2);
  for (const int other : {0, 1, 3, 4, 5}) EXPECT_LT(found.distinctive[other], 0.2) << other;
}

// A photo whose keypoints are at other places is as distinctive, but not consistent.
TEST_F(Scores, PreferMatchesWithOneDisplacement) {
  CodedKeypoints shifted = photos_.photo(1), mixed = photos_.photo(1);
  shifted.places.col(0).array() += 0.2F;
  for (Eigen::Index i = 0; i < mixed.places.rows(); ++i)
    mixed.places.row(i) = photos_.photo(1).places.row((i + 37) % mixed.places.rows());
  const PhotoScores together = scores(shifted), apart = scores(mixed);
  EXPECT_FLOAT_EQ(together.distinctive[1], apart.distinctive[1]);
  EXPECT_GT(together.consistent[1], 2 * apart.consistent[1]);
}

// One with many keypoints has a similar one for each.
TEST_F(Scores, AreNotLargerForPhotosWithManyKeypoints) {
  CodedKeypoints image = photos_.photo(0);
  std::normal_distribution<float> noise(0, 12);
  for (Eigen::Index i = 0; i < image.codes.size(); ++i)
    image.codes.data()[i] = static_cast<int8_t>(std::lround(image.codes.data()[i] + noise(random_)));
  photos_.add(randomKeypoints(2000, random_));
  const PhotoScores found = scores(image);
  EXPECT_GT(found.logarithms()[0], found.logarithms()[6] + 1);
}

TEST(BackgroundDistances, AreThoseOfTheKthNearestPhoto) {
  std::vector<PhotoMatches> matches(3);
  matches[0].distances.resize(2);
  matches[1].distances.resize(2);
  matches[2].distances.resize(2);
  matches[0].distances << 5, 1;
  matches[1].distances << 3, 2;
  matches[2].distances << 4, 9;
  EXPECT_TRUE((backgroundDistances(matches, 2) == Eigen::Array2f(4, 2)).all());
  EXPECT_TRUE((backgroundDistances(matches, 16) == Eigen::Array2f(5, 9)).all());
  EXPECT_EQ(backgroundDistances({}, 2).size(), 0);
}

TEST_F(Scores, WithoutKeypointsAreZero) {
  const PhotoScores found = scores(randomKeypoints(0, random_));
  EXPECT_TRUE((found.distinctive == 0).all());
  EXPECT_TRUE((found.consistent == 0).all());
  EXPECT_TRUE(found.logarithms().isFinite().all());
}

}  // namespace
}  // namespace sextant
