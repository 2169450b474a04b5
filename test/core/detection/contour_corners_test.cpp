// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "contour_corners.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

using Quad = std::array<cv::Point2f, 4>;

// Pixels whose centres lie in the quad are set.
cv::Mat filled(const Quad& quad) {
  const std::vector<cv::Point2f> polygon(quad.begin(), quad.end());
  cv::Mat image(120, 160, CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if (cv::pointPolygonTest(polygon, cv::Point2f(cv::Point(x, y)), false) >= 0)
        image.at<uchar>(y, x) = 255;
  return image;
}

Quad cornersOf(const cv::Mat& dark) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(dark, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  for (const auto& contour : contours) {
    std::vector<cv::Point> polygon;
    cv::approxPolyDP(contour, polygon, 6, true);
    const cv::Rect box = cv::boundingRect(contour);
    if (polygon.size() == 4 && box.width < dark.cols - 4) return contourCorners(contour, polygon);
  }
  return {};
}

double worst(const Quad& found, const Quad& truth) {
  double least = 1e9;
  for (int turn = 0; turn < 4; ++turn) {
    double most = 0;
    for (int i = 0; i < 4; ++i) most = std::max(most, cv::norm(found[(i + turn) % 4] - truth[i]));
    least = std::min(least, most);
  }
  return least;
}

const std::vector<Quad> kQuads = {{{{30.3F, 20.1F}, {120.6F, 30.2F}, {110.4F, 100.7F}, {25.2F, 90.9F}}},
                                  {{{70.0F, 10.0F}, {110.0F, 60.5F}, {60.2F, 110.0F}, {20.0F, 55.0F}}},
                                  {{{40.2F, 40.4F}, {60.7F, 43.1F}, {60.1F, 62.9F}, {39.6F, 61.0F}}}};

TEST(ContourCorners, LieWhereTheSidesOfADarkQuadMeet) {
  for (const Quad& quad : kQuads) EXPECT_LT(worst(cornersOf(filled(quad)), quad), 0.8);
}

TEST(ContourCorners, LieThereForALightQuadToo) {
  for (const Quad& quad : kQuads) EXPECT_LT(worst(cornersOf(255 - filled(quad)), quad), 0.8);
}

// As they are after a threshold, or where something hides them.
TEST(ContourCorners, DoNotMoveWithABluntCorner) {
  cv::Mat image = filled(kQuads[0]);
  cv::fillConvexPoly(image, std::vector<cv::Point>{{28, 18}, {36, 18}, {28, 26}}, cv::Scalar(0));
  EXPECT_LT(worst(cornersOf(image), kQuads[0]), 0.8);
}

}  // namespace
}  // namespace sextant
