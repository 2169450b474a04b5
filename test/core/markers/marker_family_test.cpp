// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_family.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <utility>

#include "sextant/markers/aruco_dictionary.hpp"

namespace sextant {
namespace {

TEST(MarkerFamily, KnowsWhatBothLibrariesHave) {
  const auto names = markerFamilies();
  const bool has_36h10 = std::count(names.begin(), names.end(), "tag36h10") > 0;  // libapriltag 0.10 lacks it
  EXPECT_EQ(names.size(), 21u + (has_36h10 ? 9u : 8u));
  EXPECT_EQ(familySize("DICT_4X4_50"), 50);
  EXPECT_EQ(familySize("DICT_ARUCO_ORIGINAL"), 1024);
  EXPECT_EQ(familySize("tag36h11"), 587);
  EXPECT_EQ(familySize("tagStandard41h12"), 2115);
}

TEST(MarkerFamily, OnePrintHasOneName) {
  EXPECT_EQ(canonicalFamily("DICT_APRILTAG_36h11"), "tag36h11");
  EXPECT_EQ(canonicalFamily("DICT_APRILTAG_16h5"), "tag16h5");
  EXPECT_EQ(canonicalFamily("DICT_5X5_1000"), "DICT_5X5_1000");
  EXPECT_THROW(canonicalFamily("DICT_36h11"), std::invalid_argument);
}

TEST(MarkerFamily, LibapriltagDetectsItsOwnFamilies) {
  EXPECT_TRUE(isAprilTag(canonicalFamily("DICT_APRILTAG_36h11")));
  EXPECT_TRUE(isAprilTag("tagCircle21h7"));
  EXPECT_FALSE(isAprilTag("DICT_6X6_250"));
}

// OpenCV draws the print of libapriltag upside down.
TEST(MarkerFamily, BothLibrariesHaveOnePrint) {
  for (const auto& [dictionary, tag] :
       {std::pair("DICT_APRILTAG_16h5", "tag16h5"), std::pair("DICT_APRILTAG_25h9", "tag25h9"),
        std::pair("DICT_APRILTAG_36h11", "tag36h11")}) {
    const cv::Mat theirs = arucoModules(makeArucoDictionary(dictionary), 7);
    const MarkerImage marker = markerImage(tag, 7);
    cv::Mat turned;
    cv::rotate(theirs, turned, cv::ROTATE_180);
    const cv::Range inside(marker.border_begin, marker.border_end);
    EXPECT_EQ(cv::norm(turned, marker.modules(inside, inside), cv::NORM_INF), 0) << tag;
  }
}

TEST(MarkerFamily, DrawsThePublishedPrint) {
  // tag36h11 number 0 as apriltag-imgs has it: a white ring, a black one, then 36 bits.
  const MarkerImage tag = markerImage("tag36h11", 0);
  ASSERT_EQ(tag.modules.size(), cv::Size(10, 10));
  EXPECT_EQ(tag.border_begin, 1);
  EXPECT_EQ(tag.border_end, 9);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(tag.modules.at<uchar>(0, i), 255);
  for (int i = 1; i < 9; ++i) EXPECT_EQ(tag.modules.at<uchar>(1, i), 0);
  // The first row of bits of code 0xd5d628584: 1101 01...
  const int bits[] = {1, 1, 0, 1, 0, 1};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(tag.modules.at<uchar>(2, 2 + i), 255 * bits[i]) << i;
  EXPECT_THROW(markerImage("tag36h11", 587), std::invalid_argument);
  EXPECT_THROW(markerImage("DICT_4X4_50", -1), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
