// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "image_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

// Dark to the left of x = 20.25 + 0.1 y, light to the right, one pixel of blur.
cv::Mat slantedStep() {
  cv::Mat image(50, 60, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(120 + 80 * std::erf((x - 20.25 - 0.1 * y) / M_SQRT2));
  return image;
}

const Eigen::Vector2d kBegin(20.25 + 4.5, 45), kEnd(20.25 + 0.5, 5);

TEST(ImageLines, MeetTheCurveOncePerRow) {
  const cv::Mat image = slantedStep();
  const EdgeCurve curve(kBegin, kEnd, false);
  const ImageLines lines(image, curve);
  for (int y = 10; y < 40; y += 10) EXPECT_NEAR(lines.crossing(y), 20.25 + 0.1 * y, 1e-9);
  const auto span = lines.span(3, 12);
  EXPECT_GT(span.first, 5);
  EXPECT_LT(span.last, 45);
  EXPECT_LE(span.count(), 12);
  EXPECT_GE(span.count(), 6);
}

TEST(ImageLines, SeeTheStepWhereItIs) {
  const cv::Mat image = slantedStep();
  const EdgeCurve curve(kBegin, kEnd, false);
  const ImageLines lines(image, curve);
  const double x = 20.25 + 0.1 * 20;
  const auto there = lines.moments(20, x, 4);
  ASSERT_TRUE(there);
  EXPECT_NEAR(there->first / there->contrast, 0, 0.02);
  const auto beside = lines.moments(20, x - 0.3, 4);
  EXPECT_NEAR(beside->first / (beside->contrast * beside->sharpness()), 0.3, 0.03);
  EXPECT_NEAR(*lines.steepest(20, x, 3, 12), x, 0.6);
}

TEST(ImageLines, SayNothingOutsideOfTheImage) {
  const cv::Mat image = slantedStep();
  const EdgeCurve curve(kBegin, kEnd, false);
  const ImageLines lines(image, curve);
  EXPECT_FALSE(lines.moments(-1, 20, 3));
  EXPECT_FALSE(lines.moments(50, 20, 3));
  EXPECT_FALSE(lines.moments(20, 1, 3));
  EXPECT_FALSE(lines.steepest(20, 58, 3, 12));
  EXPECT_FALSE(lines.steepest(20, 50, 3, 12));  // flat
}

}  // namespace
}  // namespace sextant
