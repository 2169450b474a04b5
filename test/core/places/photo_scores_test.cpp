// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/photo_scores.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "random_keypoints.hpp"

namespace sextant {
namespace {

constexpr int kWidth = 32, kPhotos = 6;

class PhotoScoresTest : public testing::Test {
 protected:
  PhotoScoresTest() {
    for (int p = 0; p < kPhotos; ++p) photos_.push_back(randomKeypoints(80, kWidth, random_));
  }

  PhotoScores scores(const Keypoints& image, int k = 4) const {
    std::vector<CodedKeypoints> views;
    for (const Keypoints& photo : photos_) views.push_back(photo.view());
    return scorePhotos(image.view(), views, k);
  }

  std::mt19937 random_{7};
  std::vector<Keypoints> photos_;
};

TEST_F(PhotoScoresTest, OfAPhotoItselfAreThoseOfEqualCodes) {
  const PhotoScores found = scores(photos_[2]);
  EXPECT_NEAR(found.distinctive[2], 1, 1e-6);
  // The displacement 0 is in the middle of a cell of .05, .1 and .2, and 4/9 of a cell of .45 away from it.
  EXPECT_NEAR(found.consistent[2], 3 + 25.0 / 81, 1e-3);
  for (const int other : {0, 1, 3, 4, 5}) EXPECT_LT(found.distinctive[other], 0.2) << other;
  EXPECT_TRUE((found.nearest == 0).all());
}

// A photo whose keypoints are at other places is as distinctive, but not consistent.
TEST_F(PhotoScoresTest, PreferMatchesWithOneDisplacement) {
  Keypoints shifted = photos_[1], mixed = photos_[1];
  shifted.positions.col(0).array() += 13107;
  for (Eigen::Index i = 0; i < mixed.positions.rows(); ++i)
    mixed.positions.row(i) = photos_[1].positions.row((i + 37) % mixed.positions.rows());
  const PhotoScores together = scores(shifted), apart = scores(mixed);
  EXPECT_FLOAT_EQ(together.distinctive[1], apart.distinctive[1]);
  EXPECT_GT(together.consistent[1], 2 * apart.consistent[1]);
}

// A photo with many keypoints has a similar one for each.
TEST_F(PhotoScoresTest, AreNotLargerForPhotosWithManyKeypoints) {
  Keypoints image = photos_[0];
  std::normal_distribution<double> noise(0, 25);
  for (Eigen::Index i = 0; i < image.codes.size(); ++i)
    image.codes.data()[i] =
        static_cast<int8_t>(std::lround(std::clamp(image.codes.data()[i] + noise(random_), -128.0, 127.0)));
  photos_.push_back(randomKeypoints(2000, kWidth, random_));
  const PhotoScores found = scores(image);
  EXPECT_GT(found.distinctive[0], 2 * found.distinctive[kPhotos]);
  EXPECT_GT(found.consistent[0], 2 * found.consistent[kPhotos]);
}

// Distances from 1 keypoint with code 0: the distances of two keypoints of each photo are those of its codes.
TEST(PhotoScores, BackgroundIsTheKthNearestOfTwoKeypointsOfEachPhoto) {
  const auto keypoints = [](const std::vector<int8_t>& codes) {
    const auto count = static_cast<Eigen::Index>(codes.size());
    Keypoints made{CodedKeypoints::Positions::Constant(count, 2, 30000), CodedKeypoints::Codes(count, 1)};
    std::copy(codes.begin(), codes.end(), made.codes.data());
    return made;
  };
  const Keypoints image = keypoints({0}), a = keypoints({5, 9, 10}), b = keypoints({7}),
                  c = keypoints({8, 6}), none = keypoints({});
  const std::vector<CodedKeypoints> photos = {a.view(), b.view(), none.view(), c.view()};
  const float expected[] = {5, 6, 7, 8, 9, 9};
  for (int k = 1; k <= 6; ++k) EXPECT_EQ(scorePhotos(image.view(), photos, k).background[0], expected[k - 1]);
  const PhotoScores found = scorePhotos(image.view(), photos, 4);
  EXPECT_EQ(found.nearest[0], 5);
  EXPECT_NEAR(found.distinctive[0], (1 - 5 / 8.0) / std::sqrt(3), 1e-6);
  EXPECT_EQ(found.distinctive[2], 0);
}

TEST_F(PhotoScoresTest, WithoutKeypointsAreZero) {
  const PhotoScores found = scores(randomKeypoints(0, kWidth, random_));
  EXPECT_TRUE((found.distinctive == 0).all());
  EXPECT_TRUE((found.consistent == 0).all());
  EXPECT_EQ(scorePhotos(photos_[0].view(), {}, 4).distinctive.size(), 0);
}

}  // namespace
}  // namespace sextant
