// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/photo_matches.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "random_keypoints.hpp"

namespace sextant {
namespace {

constexpr int kWidth = 20;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

// In double precision, by definition.
Eigen::MatrixXd distancesOf(const Keypoints& a, const Keypoints& b) {
  Eigen::MatrixXd distances(a.codes.rows(), b.codes.rows());
  for (Eigen::Index i = 0; i < distances.rows(); ++i)
    for (Eigen::Index j = 0; j < distances.cols(); ++j)
      distances(i, j) = (a.codes.row(i).cast<double>() - b.codes.row(j).cast<double>()).norm();
  return distances;
}

TEST(PhotoMatches, AreTheTwoMostSimilarKeypoints) {
  std::mt19937 random(1);
  const Keypoints image = randomKeypoints(31, kWidth, random);
  for (const int count : {57, 2}) {
    const Keypoints photo = randomKeypoints(count, kWidth, random);
    const PhotoMatches found = matchPhoto(image.view(), photo.view());
    Eigen::MatrixXd distances = distancesOf(image, photo);
    for (Eigen::Index i = 0; i < distances.rows(); ++i) {
      Eigen::Index nearest, back;
      EXPECT_NEAR(found.distances[i], distances.row(i).minCoeff(&nearest), 1e-3);
      EXPECT_EQ(found.rows[i], nearest);
      distances.col(nearest).minCoeff(&back);
      EXPECT_EQ(found.mutual[i], back == i);
      Eigen::RowVectorXd others = distances.row(i);
      others[nearest] = kInfinite;
      EXPECT_NEAR(found.seconds[i], others.minCoeff(), 1e-3);
    }
  }
}

TEST(PhotoMatches, MayBeNone) {
  std::mt19937 random(1);
  const Keypoints three = randomKeypoints(3, kWidth, random), one = randomKeypoints(1, kWidth, random),
                  none = randomKeypoints(0, kWidth, random);
  const PhotoMatches nothing = matchPhoto(three.view(), none.view());
  EXPECT_TRUE((nothing.distances == kInfinite).all());
  EXPECT_TRUE((nothing.rows == -1).all());
  EXPECT_FALSE(nothing.mutual.any());
  const PhotoMatches single = matchPhoto(three.view(), one.view());
  EXPECT_TRUE((single.rows == 0).all());
  EXPECT_TRUE((single.seconds == kInfinite).all());
  EXPECT_EQ(single.mutual.count(), 1);
  EXPECT_EQ(matchPhoto(none.view(), three.view()).distances.size(), 0);
}

TEST(PhotoMatches, RefuseOtherCodes) {
  std::mt19937 random(1);
  const Keypoints image = randomKeypoints(2, kWidth, random), wider = randomKeypoints(2, kWidth + 1, random);
  EXPECT_THROW(matchPhoto(image.view(), wider.view()), std::invalid_argument);
  Keypoints incomplete = image;
  incomplete.positions = image.positions.topRows(1);
  EXPECT_THROW(matchPhoto(image.view(), incomplete.view()), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
