// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "quad_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

// Squares of these sides, dark on light, the first turned by 20 degrees.
cv::Mat squares(const std::vector<cv::RotatedRect>& places, double noise) {
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(180)), grains(image.size(), CV_32F), noisy;
  for (const cv::RotatedRect& place : places) {
    cv::Point2f corners[4];
    place.points(corners);
    const std::vector<cv::Point> polygon(corners, corners + 4);
    cv::fillConvexPoly(image, polygon, cv::Scalar(40), cv::LINE_AA);
  }
  cv::GaussianBlur(image, image, {}, 0.8);
  cv::RNG random(3);
  random.fill(grains, cv::RNG::NORMAL, 0, noise);
  image.convertTo(noisy, CV_32F);
  cv::Mat(noisy + grains).convertTo(image, CV_8UC1);
  return image;
}

bool holds(const std::vector<QuadCandidate>& found, const cv::RotatedRect& place) {
  const cv::Rect box = place.boundingRect();
  for (const QuadCandidate& quad : found) {
    const cv::Rect common = quad.box & box;
    const bool covers = common.area() > 0.8 * box.area() && quad.box.area() < 1.6 * box.area();
    if (covers && std::abs(quad.side - place.size.width) < 4 + 0.1 * place.size.width) return true;
  }
  return false;
}

TEST(QuadSearch, FindsSmallAndLargeOnesTheLargestFirst) {
  const std::vector<cv::RotatedRect> places = {
      {{300, 240}, {200, 200}, 20}, {{80, 80}, {40, 40}, 0}, {{560, 400}, {16, 16}, 30}};
  for (const Effort effort : {Effort::quick, Effort::thorough})
    for (const double noise : {0.0, 4.0}) {
      QuadSearch search;
      const auto& found = search.find(squares(places, noise), {0, 0, 640, 480}, 12, effort);
      for (const auto& place : places) EXPECT_TRUE(holds(found, place)) << place.center << " noise " << noise;
      size_t smaller = 1;
      while (smaller < found.size() && found[smaller - 1].box.area() >= found[smaller].box.area()) ++smaller;
      for (size_t i = smaller + 1; i < found.size(); ++i)  // those at a quarter of the resolution
        EXPECT_GE(found[i - 1].box.area(), found[i].box.area());
      EXPECT_TRUE(effort == Effort::thorough || smaller >= found.size());
      EXPECT_LE(search.distinct().size(), 5u);
    }
}

TEST(QuadSearch, LooksOnlyWhereItIsTold) {
  const cv::RotatedRect left({100, 240}, {60, 60}, 10), right({501, 241}, {60, 60}, 40);
  const cv::Mat image = squares({left, right}, 2);
  QuadSearch search;
  const auto& found = search.find(image, {401, 101, 200, 300}, 12, Effort::quick);
  EXPECT_TRUE(holds(found, right));
  EXPECT_FALSE(holds(found, left));
}

// In the half image its shorter side has six pixels, of which a blunt corner takes one or two.
TEST(QuadSearch, FindsNarrowOnesWhereverTheyLieAmongPixels) {
  for (int step = 0; step < 8; ++step) {
    const cv::RotatedRect place({300 + 0.25f * step, 200 + 0.5f * step}, {12, 40}, 0.5f * step);
    QuadSearch search;
    for (const Effort effort : {Effort::quick, Effort::thorough})
      EXPECT_TRUE(holds(search.find(squares({place}, 2), {1, 1, 637, 475}, 8, effort), place)) << step;
  }
}

// That is less than one of the half image: where the lines of its sides meet, not where its pixels do.
TEST(QuadSearch, TellsCornersWithinOneAndAHalfPixels) {
  const cv::RotatedRect place({300, 240}, {80, 60}, 20);
  QuadSearch search;
  search.find(squares({place}, 2), {1, 1, 637, 475}, 12, Effort::thorough);
  cv::Point2f corners[4];
  place.points(corners);
  const QuadCandidate quad = search.distinct().front();
  for (const cv::Point2f& corner : corners)
    EXPECT_TRUE(std::any_of(quad.corners.begin(), quad.corners.end(),
                            [&](const cv::Point2f& found) { return cv::norm(found - corner) < 1.5; }));
}

TEST(QuadSearch, TellsNothingBelowTheAskedSize) {
  const cv::RotatedRect place({300, 200}, {30, 30}, 0);
  const cv::Mat image = squares({place}, 0);
  QuadSearch search;
  EXPECT_TRUE(holds(search.find(image, {0, 0, 640, 480}, 20, Effort::quick), place));
  EXPECT_TRUE(search.find(image, {0, 0, 640, 480}, 60, Effort::quick).empty());
  EXPECT_TRUE(search.find(image, {0, 0, 3, 3}, 20, Effort::quick).empty());
}

}  // namespace
}  // namespace sextant
