// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/detection/marker_detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

constexpr int kModule = 12;  // pixels
constexpr int kQuiet = 3;    // modules of white around the print

struct Print {
  cv::Mat image;
  Corners corners;
};

// A marker as printed, head-on: its corners lie half a pixel outside of its outermost pixels' centres.
Print print(const std::string& family, int id) {
  const MarkerImage marker = markerImage(family, id);
  const int side = (marker.modules.cols + 2 * kQuiet) * kModule;
  cv::Mat large;
  cv::resize(marker.modules, large, {}, kModule, kModule, cv::INTER_NEAREST);
  Print result{cv::Mat(side, side, CV_8UC1, cv::Scalar(255)), {}};
  large.copyTo(result.image(cv::Rect(kQuiet * kModule, kQuiet * kModule, large.cols, large.rows)));
  cv::GaussianBlur(result.image, result.image, {}, 0.8);
  const double begin = (kQuiet + marker.border_begin) * kModule - 0.5,
               end = (kQuiet + marker.border_end) * kModule - 0.5;
  result.corners = {Eigen::Vector2d(begin, begin), {end, begin}, {end, end}, {begin, end}};
  return result;
}

DetectorParams paramsFor(const std::string& family) {
  DetectorParams params;
  params.families = {family};
  params.max_hamming =
      family == "tagStandard52h13" ? 0 : 1;  // that family's table of corrected codes is large
  return params;
}

double worstCorner(const Corners& a, const Corners& b) {
  double worst = 0;
  for (int i = 0; i < 4; ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

class EveryFamily : public testing::TestWithParam<std::string> {};

TEST_P(EveryFamily, ReadsItsOwnPrintsUpright) {
  const std::string family = GetParam();
  const auto detector = makeMarkerDetector(paramsFor(family));
  const int count = familySize(family);
  for (const int id : {0, 1, count / 2, count - 1}) {
    const Print marker = print(family, id);
    const auto found = detector->detect(marker.image);
    const auto same =
        std::find_if(found.begin(), found.end(), [&](const Detection& d) { return d.key.id == id; });
    ASSERT_NE(same, found.end()) << family << " " << id;
    EXPECT_EQ(same->key.family, canonicalFamily(family));
    EXPECT_LT(worstCorner(same->corners, marker.corners), 0.1) << family << " " << id;
  }
}

// New ones are found by the outline of their border, whichever side of it is black.
TEST_P(EveryFamily, FindsItsPrintsAnewWithinThreeImagesWhileTracking) {
  const std::string family = GetParam();
  DetectorParams params = paramsFor(family);
  params.search = "tracking";
  const auto detector = makeMarkerDetector(params);
  const Print marker = print(family, 0);
  const cv::Mat blank(marker.image.size(), CV_8UC1, cv::Scalar(255));
  EXPECT_TRUE(detector->detect(blank).empty());
  std::vector<Detection> found;
  for (int i = 0; i < 3 && found.empty(); ++i) found = detector->detect(marker.image);
  ASSERT_EQ(found.size(), 1u) << family;
  EXPECT_LT(worstCorner(found[0].corners, marker.corners), 0.1) << family;
  EXPECT_EQ(detector->detect(marker.image).size(), 1u);  // and then where it was
}

std::string testName(const testing::TestParamInfo<std::string>& info) { return info.param; }
INSTANTIATE_TEST_SUITE_P(All, EveryFamily, testing::ValuesIn(markerFamilies()), testName);

TEST(MarkerDetector, APrintHasOnePoseByBothOfItsNames) {
  const auto families = markerFamilies();
  for (const std::string suffix : {"16h5", "25h9", "36h10", "36h11"}) {
    if (std::count(families.begin(), families.end(), "tag" + suffix) == 0) continue;  // libapriltag 0.10
    const Print marker = print("tag" + suffix, 7);
    const auto a = makeMarkerDetector(paramsFor("tag" + suffix))->detect(marker.image);
    const auto b = makeMarkerDetector(paramsFor("DICT_APRILTAG_" + suffix))->detect(marker.image);
    ASSERT_EQ(a.size(), 1u);
    ASSERT_EQ(b.size(), 1u);
    EXPECT_EQ(a[0].key, b[0].key);
    EXPECT_EQ(a[0].corners, b[0].corners);
  }
}

TEST(MarkerDetector, SearchesSeveralFamiliesAtOnce) {
  cv::Mat both;
  cv::Mat aruco = print("DICT_5X5_50", 3).image, tag = print("tag25h9", 4).image;
  const int side = std::max(aruco.rows, tag.rows);
  cv::copyMakeBorder(aruco, aruco, 0, side - aruco.rows, 0, 0, cv::BORDER_CONSTANT, 255);
  cv::copyMakeBorder(tag, tag, 0, side - tag.rows, 0, 0, cv::BORDER_CONSTANT, 255);
  cv::hconcat(aruco, tag, both);
  DetectorParams params;
  params.families = {"DICT_5X5_50", "tag25h9", "tag36h11"};
  const auto found = makeMarkerDetector(params)->detect(both);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].key, (MarkerKey{"DICT_5X5_50", 3}));
  EXPECT_EQ(found[1].key, (MarkerKey{"tag25h9", 4}));
}

TEST(MarkerDetector, FindsNothingWhereNothingIs) {
  for (const std::string family : {"DICT_4X4_50", "tag36h11"}) {
    const auto detector = makeMarkerDetector(paramsFor(family));
    for (const auto size :
         {cv::Size(1, 1), cv::Size(2, 2), cv::Size(3, 200), cv::Size(17, 17), cv::Size(640, 480)})
      for (const int grey : {0, 255})
        EXPECT_TRUE(detector->detect(cv::Mat(size, CV_8UC1, cv::Scalar(grey))).empty());
    EXPECT_THROW(detector->detect(cv::Mat()), std::invalid_argument);
    EXPECT_THROW(detector->detect(cv::Mat(50, 50, CV_8UC3)), std::invalid_argument);
  }
}

// Of the white on its right, one pixel is in the image: too little for OpenCV to find the marker by itself.
TEST(MarkerDetector, ReadsAMarkerWhoseEdgeIsNearlyTheImages) {
  const Print marker = print("DICT_4X4_50", 5);
  const int right = static_cast<int>(marker.corners[1].x() + 0.5) + 1;
  for (const int low : {0, 1}) {  // both places of the edge among the half image's pixels
    const cv::Mat cut = marker.image.colRange(low, right);
    const auto found = makeMarkerDetector(paramsFor("DICT_4X4_50"))->detect(cut);
    ASSERT_EQ(found.size(), 1u) << low;
    EXPECT_EQ(found[0].key.id, 5);
    for (int i = 0; i < 4; ++i)
      EXPECT_LT((found[0].corners[i] - marker.corners[i] + Eigen::Vector2d(low, 0)).norm(),
                3 * std::max(0.1, found[0].corner_sigmas[i]));
  }
}

TEST(MarkerDetector, ReadsAViewWithPaddedRows) {
  const Print marker = print("tag36h11", 5);
  cv::Mat wide(marker.image.rows, marker.image.cols + 13, CV_8UC1, cv::Scalar(255));
  const cv::Mat view = wide(cv::Rect(0, 0, marker.image.cols, marker.image.rows));
  marker.image.copyTo(view);
  EXPECT_EQ(makeMarkerDetector(paramsFor("tag36h11"))->detect(view).size(), 1u);
}

TEST(DetectorParams, RefusesWhatIsOutOfRange) {
  const auto refused = [](auto change) {
    DetectorParams params;
    change(params);
    EXPECT_THROW(makeMarkerDetector(params), std::invalid_argument);
  };
  refused([](DetectorParams& p) { p.families = {}; });
  refused([](DetectorParams& p) { p.families = {"DICT_9X9_50"}; });
  refused([](DetectorParams& p) { p.families = {"tag36h11", "DICT_APRILTAG_36h11"}; });  // one print
  refused([](DetectorParams& p) { p.decimate = 0.5; });
  refused([](DetectorParams& p) { p.max_hamming = 4; });
  refused([](DetectorParams& p) { p.min_perimeter = 0; });
  refused([](DetectorParams& p) {
    p.families = {"tagStandard52h13"};
    p.max_hamming = 2;  // a table of 3 GB
  });
}

}  // namespace
}  // namespace sextant
