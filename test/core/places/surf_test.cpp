// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "surf.hpp"

#include <gtest/gtest.h>

#include "test_blobs.hpp"

namespace sextant {
namespace {

const cv::Size kSurfSize(320, 320);

// The determinant of the Hessian is quadratic in the contrast, and so is dlib's score.
TEST(Surf, ScoresGrowWithTheSquareOfTheContrast) {
  std::vector<double> scores;
  for (const double grey : {40.0, 80.0}) {
    const auto found = detectSurf(blobImage({{{150, 140}, 8, grey}}, kSurfSize), 0, true);
    ASSERT_FALSE(found.empty());
    EXPECT_LT(cv::norm(found[0].pt - cv::Point2f(150, 140)), 0.1);
    scores.push_back(found[0].response);
  }
  EXPECT_NEAR(scores[1] / scores[0], 4, 0.1);
  const cv::Mat bright = blobImage({{{150, 140}, 8, 80}}, kSurfSize);
  EXPECT_TRUE(detectSurf(bright, 1.01 * scores[1], true).empty());
}

TEST(Surf, AnglesFollowAQuarterTurn) {
  const cv::Mat image = blobImage(randomScene(), kSurfSize);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  const auto before = detectSurf(image, 30, false), after = detectSurf(turned, 30, false);
  int pairs = 0, agree = 0;
  for (const cv::KeyPoint& a : before)
    for (const cv::KeyPoint& b : after) {
      const cv::Point2f there(319 - a.pt.y, a.pt.x);
      if (cv::norm(b.pt - there) > 1 || std::abs(b.size - a.size) > 0.05 * a.size) continue;
      ++pairs;
      agree += std::abs(std::remainder(b.angle - a.angle - 90, 360)) < 10;
    }
  EXPECT_GT(pairs, 100);
  EXPECT_GT(agree, 0.75 * pairs);
}

TEST(Surf, UprightDescriptorIsNormalizedAndIgnoresContrast) {
  const std::vector<Blob> scene = randomScene();
  cv::Mat image = blobImage(scene, kSurfSize), pale;
  image.convertTo(pale, CV_8U, 0.5, 60);
  std::vector<cv::KeyPoint> keypoints = {{{160, 160}, 12, 0}, {{90, 200}, 20, 0}};
  const cv::Mat a = describeSurf(image, keypoints), b = describeSurf(pale, keypoints);
  ASSERT_EQ(a.size(), cv::Size(64, 2));
  for (int row = 0; row < 2; ++row) {
    EXPECT_NEAR(cv::norm(a.row(row)), 1, 1e-5);
    EXPECT_LT(cv::norm(a.row(row) - b.row(row)), 0.05);  // rounded grey levels
  }
}

TEST(Surf, DescribesKeypointsAtTheBorderButNoneLargerThanTheImage) {
  const cv::Mat image = blobImage(randomScene(), kSurfSize);
  std::vector<cv::KeyPoint> keypoints = {{{2, 318}, 12, 0}, {{160, 160}, 200, 0}, {{160, 2}, 0.5F, 0}};
  const cv::Mat descriptors = describeSurf(image, keypoints);
  ASSERT_EQ(keypoints.size(), 2u);  // 32 scales of 100 pixels are longer than three images
  EXPECT_EQ(keypoints[1].pt, cv::Point2f(160, 2));
  EXPECT_EQ(descriptors.rows, 2);
  EXPECT_TRUE(cv::checkRange(descriptors));
}

}  // namespace
}  // namespace sextant
