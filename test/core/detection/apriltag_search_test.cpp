// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "marker_search.hpp"
#include "test_search.hpp"

namespace sextant {
namespace {

DetectorParams tagParams(int max_hamming, double min_decision_margin = 20) {
  DetectorParams params;
  params.max_hamming = max_hamming;
  params.min_decision_margin = min_decision_margin;
  return params;
}

std::vector<Detection> tagsIn(const cv::Mat& image, const DetectorParams& params) {
  FoundMarkers found;
  makeAprilTagSearch(params, {"tag36h11"})->everywhere(image, found);
  return found.markers;
}

TEST(AprilTagSearch, AWindowShowsTheSameCornersAsTheImage) {
  const MarkerImage marker = markerImage("tag36h11", 9);
  const cv::Mat image = searchImage(marker.modules);
  const auto search = makeAprilTagSearch(tagParams(1), {"tag16h5", "tag36h11"});
  for (const Effort effort : {Effort::quick, Effort::thorough}) {
    FoundMarkers found;
    search->within(image, {101, 61, 140, 140}, 80, effort, found);
    ASSERT_EQ(found.markers.size(), 1u);
    EXPECT_TRUE(found.markers[0].key == (MarkerKey{"tag36h11", 9}));
    EXPECT_LT(farthestCorner(found.markers[0].corners, searchCorners(marker)), 0.5);
    EXPECT_LT(farthestCorner(found.markers[0].corners, tagsIn(image, tagParams(1))[0].corners), 0.5);
  }
}

TEST(AprilTagSearch, CorrectsAsManyBitsAsItIsSetTo) {
  cv::Mat modules = markerImage("tag36h11", 9).modules.clone();
  for (const int column : {3, 5}) modules.at<uchar>(4, column) ^= 255;
  const cv::Mat image = searchImage(modules);
  EXPECT_TRUE(tagsIn(image, tagParams(1)).empty());
  const auto found = tagsIn(image, tagParams(2));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].key.id, 9);
  EXPECT_EQ(found[0].hamming, 2);
}

TEST(AprilTagSearch, LeavesOutWhatHasTooLittleContrast) {
  cv::Mat image = searchImage(markerImage("tag36h11", 9).modules);
  const double margin = tagsIn(image, tagParams(0))[0].decision_margin;
  image.convertTo(image, CV_8U, 0.25, 100);
  EXPECT_NEAR(tagsIn(image, tagParams(0))[0].decision_margin, margin / 4, 2);
  EXPECT_TRUE(tagsIn(image, tagParams(0, margin / 4 + 3)).empty());
}

TEST(AprilTagSearch, ReadsATagInPlaceOrNot) {
  const MarkerImage marker = markerImage("tag36h11", 9);
  const cv::Mat image = searchImage(marker.modules);
  const auto search = makeAprilTagSearch(tagParams(1), {"tag16h5", "tag36h11"});
  const auto reads = [&](int id, const Corners& corners) {
    Detection tag;
    tag.key = {"tag36h11", id};
    tag.corners = corners;
    return search->readAt(image, tag) && tag.hamming == 0 && tag.decision_margin > 50;
  };
  const Corners corners = searchCorners(marker);
  EXPECT_TRUE(reads(9, corners));
  EXPECT_FALSE(reads(8, corners));
  EXPECT_FALSE(reads(9, {corners[1], corners[2], corners[3], corners[0]}));
}

// Random squares have one of its codes every fourth time, with two wrong bits.
TEST(AprilTagSearch, TakesNoTextureForASmallCode) {
  cv::RNG random(3);
  const auto search = makeAprilTagSearch(tagParams(2, 0), {"tag16h5"});
  FoundMarkers found;
  for (int i = 0; i < 40; ++i) {
    cv::Mat modules(8, 8, CV_8U, cv::Scalar(255)), square = modules({1, 1, 6, 6}),
                                                   inside = modules({2, 2, 4, 4});
    square = 40;
    random.fill(inside, cv::RNG::UNIFORM, 40, 256);
    search->everywhere(searchImage(modules), found);
  }
  EXPECT_LE(found.markers.size(), 1u);
  search->everywhere(searchImage(markerImage("tag16h5", 7).modules), found);
  EXPECT_EQ(found.markers.back().key.id, 7);
}

TEST(AprilTagSearch, KnowsItsFamilies) {
  const auto search = makeAprilTagSearch(tagParams(0), {"tag36h11", "tagCircle21h7"});
  EXPECT_EQ(search->border({"tag36h11", 0}).modules, 8);
  EXPECT_FALSE(search->border({"tag36h11", 0}).white_inside);
  EXPECT_EQ(search->border({"tagCircle21h7", 0}).modules, 5);
  EXPECT_TRUE(search->border({"tagCircle21h7", 0}).white_inside);
  EXPECT_THROW(search->border({"tag25h9", 0}), std::logic_error);
  EXPECT_NEAR(search->minSide({640, 480}), 11.2, 1e-9);  // 1.4 pixels a module
  FoundMarkers found;
  search->everywhere(cv::Mat(15, 400, CV_8U, cv::Scalar(0)), found);  // too small for libapriltag
  EXPECT_TRUE(found.markers.empty());
}

}  // namespace
}  // namespace sextant
