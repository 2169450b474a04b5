// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "edge_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

constexpr double kBlur = 1.0;  // pixels

double truth(double y, double bow) { return 30.3 + 0.05 * y + bow * (y - 40) * (y - 40); }

// Dark to the left of the curve, light to the right.
cv::Mat bentStep(double bow) {
  cv::Mat image(80, 60, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<uchar>(y, x) =
          cv::saturate_cast<uchar>(120 + 80 * std::erf((x - truth(y, bow)) / (kBlur * M_SQRT2)));
  return image;
}

// Runs up the image: light is on the right.
EdgeCurve startOff(double by) { return {{truth(70, 0) + by, 70}, {truth(10, 0) - by, 10}, false}; }

TEST(EdgeFit, FindsAStraightEdgeAndItsBlur) {
  const auto fit = fitEdge(bentStep(0), startOff(0.8), {4, 100, 2});
  ASSERT_TRUE(fit);
  for (const double s : {-1.0, 0.0, 1.0}) {
    const Eigen::Vector2d p = fit->curve.at(s);
    EXPECT_NEAR(p.x(), truth(p.y(), 0), 0.05);
  }
  const auto again = fitEdge(bentStep(0), fit->curve, {4, 100, 2});  // a start that is off blurs too
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->blur, kBlur, 0.2);
  EXPECT_GT(fit->contrast, 100);
}

TEST(EdgeFit, FollowsABentEdgeWithThreeTerms) {
  const double bow = 5e-4;
  const cv::Mat image = bentStep(bow);
  const auto bent = fitEdge(image, startOff(0), {4, 100, 3});
  ASSERT_TRUE(bent);
  for (const double s : {-1.0, 0.0, 1.0}) {
    const Eigen::Vector2d p = bent->curve.at(s);
    EXPECT_NEAR(p.x(), truth(p.y(), bow), 0.05);
  }
}

// The variance of a line's end is about four times that of its middle (of n samples: 4 / n and 1 / n).
TEST(EdgeFit, KnowsItsEndsLessThanItsMiddle) {
  const auto fit = fitEdge(bentStep(0), startOff(0), {4, 100, 2});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->leverage(1) / fit->leverage(0), 4, 0.6);
}

TEST(EdgeFit, NeedsHalfOfTheEdge) {
  cv::Mat image = bentStep(0);
  image.rowRange(0, 30) = 120;
  EXPECT_TRUE(fitEdge(image, startOff(0), {4, 100, 2}));
  EXPECT_TRUE(searchEdge(image, startOff(1.5), {3.5, 12, 2}));
  image.rowRange(0, 50) = 120;
  EXPECT_FALSE(fitEdge(image, startOff(0), {4, 100, 2}));
  EXPECT_FALSE(searchEdge(image, startOff(1.5), {3.5, 12, 2}));
}

}  // namespace
}  // namespace sextant
