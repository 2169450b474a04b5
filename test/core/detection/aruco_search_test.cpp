// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "marker_search.hpp"
#include "test_search.hpp"

namespace sextant {
namespace {

TEST(ArucoSearch, AWindowShowsTheSameCornersAsTheImage) {
  const MarkerImage marker = markerImage("DICT_5X5_100", 7);
  const cv::Mat image = searchImage(marker.modules);
  const auto search = makeArucoSearch({}, "DICT_5X5_100");
  FoundMarkers whole, part;
  search->everywhere(image, whole);
  search->within(image, {91, 51, 150, 150}, 70, Effort::quick, part);
  for (const auto& found : {whole.markers, part.markers}) {
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(found[0].key == (MarkerKey{"DICT_5X5_100", 7}));
    EXPECT_LT(farthestCorner(found[0].corners, searchCorners(marker)), 1.5);
  }
}

bool readsAt(MarkerSearch& search, const cv::Mat& image, const MarkerKey& key, const Corners& corners) {
  Detection marker;
  marker.key = key;
  marker.corners = corners;
  return search.readAt(image, marker);
}

TEST(ArucoSearch, ReadsAMarkerInPlaceOrNot) {
  const std::string family = "DICT_5X5_100";
  const MarkerImage marker = markerImage(family, 7);
  const cv::Mat image = searchImage(marker.modules);
  const auto search = makeArucoSearch({}, family);
  const Corners corners = searchCorners(marker);
  EXPECT_TRUE(readsAt(*search, image, {family, 7}, corners));
  EXPECT_FALSE(readsAt(*search, image, {family, 8}, corners));
  EXPECT_FALSE(readsAt(*search, image, {family, 7}, {corners[1], corners[2], corners[3], corners[0]}));
  Corners aside = corners;
  for (auto& corner : aside) corner.x() += 30;
  EXPECT_FALSE(readsAt(*search, image, {family, 7}, aside));
}

TEST(ArucoSearch, KnowsItsLimits) {
  DetectorParams params;
  params.min_perimeter = 0.2;
  const auto search = makeArucoSearch(params, "DICT_4X4_50");
  EXPECT_EQ(search->border({"DICT_4X4_50", 0}).modules, 6);
  EXPECT_DOUBLE_EQ(search->minSide({640, 480}), 32);       // a quarter of the perimeter
  EXPECT_DOUBLE_EQ(search->minSide({100, 100}), 1.4 * 6);  // what can be read
  EXPECT_TRUE(search->readsInPlace());
}

}  // namespace
}  // namespace sextant
