// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/corner_refiner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sextant/core/marker_family.hpp"

namespace sextant {
namespace {

constexpr int kSuper = 8;  // samples a pixel and axis

// A tag36h11 print warped onto these corners, averaged from 64 samples a pixel.
cv::Mat render(const Corners& corners, double noise) {
  const MarkerImage marker = markerImage("tag36h11", 9);
  cv::Mat padded, large;
  cv::copyMakeBorder(marker.modules, padded, 2, 2, 2, 2, cv::BORDER_CONSTANT, 255);
  const float begin = 2 + marker.border_begin - 0.5f, end = 2 + marker.border_end - 0.5f;
  const std::vector<cv::Point2f> from = {{begin, begin}, {end, begin}, {end, end}, {begin, end}};
  std::vector<cv::Point2f> to;
  for (const auto& corner : corners)
    to.emplace_back(kSuper * (corner.x() + 0.5) - 0.5, kSuper * (corner.y() + 0.5) - 0.5);
  cv::warpPerspective(padded, large, cv::getPerspectiveTransform(from, to), {160 * kSuper, 120 * kSuper},
                      cv::INTER_NEAREST, cv::BORDER_CONSTANT, 255);
  cv::Mat image, disturbance(120, 160, CV_16SC1);
  cv::resize(large, image, {160, 120}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(image, image, {}, 0.7);
  image.convertTo(image, CV_16SC1, 0.6, 40);
  cv::RNG random(6);
  random.fill(disturbance, cv::RNG::NORMAL, 0, noise);
  image += disturbance;
  image.convertTo(image, CV_8UC1);
  return image;
}

const Corners kTruth = {Eigen::Vector2d(50.3, 31.7), {104.2, 40.1}, {99.6, 91.4}, {46.8, 84.9}};

double worst(const Corners& a, const Corners& b) {
  double distance = 0;
  for (int i = 0; i < 4; ++i) distance = std::max(distance, (a[i] - b[i]).norm());
  return distance;
}

Corners shifted(const Corners& corners, double by) {
  Corners start = corners;
  for (int i = 0; i < 4; ++i) start[i] += by * Eigen::Vector2d(std::cos(2.0 * i), std::sin(2.0 * i));
  return start;
}

TEST(CornerRefiner, FindsTheTrueCorners) {
  for (const double shift : {0.0, 0.7, 1.4}) {
    const auto quiet = refineCorners(render(kTruth, 0), shifted(kTruth, shift), {8, false});
    ASSERT_TRUE(quiet);
    EXPECT_LT(worst(*quiet, kTruth), 0.05) << shift;
    const auto noisy = refineCorners(render(kTruth, 4), shifted(kTruth, shift), {8, false});
    ASSERT_TRUE(noisy);
    EXPECT_LT(worst(*noisy, kTruth), 0.15) << shift;
  }
}

TEST(CornerRefiner, WorksOnSquaresThatAreWhiteInside) {
  const cv::Mat negative = 255 - render(kTruth, 2);
  const auto found = refineCorners(negative, kTruth, {8, true});
  ASSERT_TRUE(found);
  EXPECT_LT(worst(*found, kTruth), 0.1);
  EXPECT_FALSE(refineCorners(negative, kTruth, {8, false}));
}

TEST(CornerRefiner, RefusesAHiddenEdgeAndAnEmptyImage) {
  cv::Mat hidden = render(kTruth, 2);
  hidden(cv::Rect(45, 20, 40, 80)) = 40;
  EXPECT_FALSE(refineCorners(hidden, kTruth, {8, false}));
  EXPECT_FALSE(refineCorners(cv::Mat(120, 160, CV_8UC1, cv::Scalar(128)), kTruth, {8, false}));
  EXPECT_FALSE(refineCorners(cv::Mat(4, 4, CV_8UC1, cv::Scalar(0)), kTruth, {8, false}));
}

}  // namespace
}  // namespace sextant
