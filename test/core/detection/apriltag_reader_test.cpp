// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "apriltag_reader.hpp"

#include <gtest/gtest.h>

#include "sextant/markers/apriltag_family.hpp"
#include "test_search.hpp"

namespace sextant {
namespace {

TEST(AprilTagReader, ReadsThePrintsOfEveryFamily) {
  for (const std::string& name : aprilTagFamilies()) {
    const AprilTagFamily family = makeAprilTagFamily(name);
    const AprilTagReader reader(*family);
    const MarkerImage marker = markerImage(name, 7);
    const auto reading = reader.read(searchImage(marker.modules), 7, searchCorners(marker));
    ASSERT_TRUE(reading) << name;
    EXPECT_EQ(reading->hamming, 0) << name;
    EXPECT_NEAR(reading->contrast, 255, 3) << name;
    EXPECT_GT(reading->clarity, 0.9) << name;
    EXPECT_GE(reader.read(searchImage(marker.modules), 8, searchCorners(marker))->hamming,
              static_cast<int>(family->h) - 1)
        << name;
  }
}

TEST(AprilTagReader, CountsFlippedBits) {
  const AprilTagFamily family = makeAprilTagFamily("tag36h11");
  MarkerImage marker = markerImage("tag36h11", 9);
  marker.modules = marker.modules.clone();
  for (const int column : {3, 5}) marker.modules.at<uchar>(4, column) ^= 255;
  const auto reading = AprilTagReader(*family).read(searchImage(marker.modules), 9, searchCorners(marker));
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->hamming, 2);
}

// Light that falls off to a tenth from one side to the other.
TEST(AprilTagReader, ReadsInUnevenAndInPoorLight) {
  const AprilTagFamily family = makeAprilTagFamily("tag36h11");
  const MarkerImage marker = markerImage("tag36h11", 9);
  cv::Mat image = searchImage(marker.modules);
  for (int x = 0; x < image.cols; ++x) image.col(x) *= 0.05 + 0.01 * 20 * x / image.cols;
  const auto reading = AprilTagReader(*family).read(image, 9, searchCorners(marker));
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->hamming, 0);
  EXPECT_LT(reading->margin, 40);
  EXPECT_GT(reading->clarity, 0.7);
}

TEST(AprilTagReader, TellsTextureByItsClarity) {
  const AprilTagFamily family = makeAprilTagFamily("tag36h11");
  const MarkerImage marker = markerImage("tag36h11", 9);
  const AprilTagReader reader(*family);
  cv::Mat image = searchImage(marker.modules);
  const int begin = (marker.border_begin + 1) * kSearchModule, side = 6 * kSearchModule;
  const cv::Mat inside = image(cv::Rect(begin, begin, side, side) + kSearchOrigin);
  inside.convertTo(inside, CV_8U, 0.1, 115);
  EXPECT_LT(reader.read(image, 9, searchCorners(marker))->clarity, 0.3);
  cv::bitwise_not(image, image);  // white border on black
  EXPECT_FALSE(reader.read(image, 9, searchCorners(marker)));
}

TEST(AprilTagReader, ReadsOneThatLeavesTheImageByHalfAModule) {
  const AprilTagFamily family = makeAprilTagFamily("tag36h11");
  const MarkerImage marker = markerImage("tag36h11", 9);
  const cv::Mat image = searchImage(marker.modules);
  Corners corners = searchCorners(marker);
  const int cut = static_cast<int>(corners[0].x()) + kSearchModule / 2;
  for (auto& corner : corners) corner.x() -= cut;
  const auto reading = AprilTagReader(*family).read(image.colRange(cut, image.cols), 9, corners);
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->hamming, 0);
  for (auto& corner : corners) corner.x() -= 1000;
  EXPECT_FALSE(AprilTagReader(*family).read(image, 9, corners));
}

}  // namespace
}  // namespace sextant
