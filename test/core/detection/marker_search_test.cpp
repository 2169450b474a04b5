// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_search.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

Detection squareAt(int id, double x, double y, double side) {
  Detection square;
  square.key = {"tag36h11", id};
  square.corners = {Eigen::Vector2d(x, y), {x + side, y}, {x + side, y + side}, {x, y + side}};
  return square;
}

TEST(FoundMarkers, OfOnePrintSeenTwiceTheLargerCounts) {
  FoundMarkers found;
  found.add(squareAt(1, 100, 100, 40));
  found.add(squareAt(1, 99, 99, 42));  // the same, by its other edge
  found.add(squareAt(1, 101, 101, 38));
  found.add(squareAt(2, 100, 100, 40));  // another id
  found.add(squareAt(1, 300, 100, 40));  // another print
  ASSERT_EQ(found.markers.size(), 3u);
  EXPECT_EQ(found.markers[0].corners[0], Eigen::Vector2d(99, 99));
  found.refined = 1;
  found.add(squareAt(1, 98, 98, 44));
  EXPECT_EQ(found.markers[0].corners[0], Eigen::Vector2d(99, 99));
  ASSERT_EQ(found.markers.size(), 3u);
}

TEST(FoundMarkers, CoverWhatIsInsideOfThem) {
  FoundMarkers found;
  found.add(squareAt(1, 100, 100, 40));
  EXPECT_TRUE(found.cover({{115, 115, 10, 10}, 10, {}}));
  EXPECT_FALSE(found.cover({{137, 115, 10, 10}, 10, {}}));  // its middle is 2 px outside
  EXPECT_TRUE(found.include({"tag36h11", 1}, squareAt(1, 115, 100, 40).corners));
  EXPECT_FALSE(found.include({"tag36h11", 1}, squareAt(1, 125, 100, 40).corners));
  EXPECT_FALSE(found.include({"tag36h11", 2}, squareAt(1, 100, 100, 40).corners));
}

TEST(MarkerSearch, WindowsEndAtTheImagesBorder) {
  const cv::Size image(640, 480);
  EXPECT_EQ(widened({10, 20, 30, 40}, 4.2, image), cv::Rect(5, 15, 40, 50));
  EXPECT_EQ(widened({2, 470, 30, 40}, 5, image), cv::Rect(0, 465, 37, 15));
  EXPECT_EQ(windowOf({{100, 100, 40, 50}, 40, {}}, image), cv::Rect(89, 89, 62, 72));  // 6 + 50 / 10
  EXPECT_FALSE(touchesBorder({1, 1, 638, 478}, image));
  for (const cv::Rect& window : {cv::Rect(0, 1, 5, 5), {1, 0, 5, 5}, {635, 1, 5, 5}, {1, 475, 5, 5}})
    EXPECT_TRUE(touchesBorder(window, image)) << window;
}

// Finds a marker of the quad's size in every window.
class Windows : public MarkerSearch {
 public:
  void everywhere(const cv::Mat&, FoundMarkers&) override {}
  void within(const cv::Mat&, const cv::Rect& window, double side, Effort, FoundMarkers& found) override {
    windows.push_back(window);
    const cv::Point middle = (window.tl() + window.br()) / 2;
    found.add(squareAt(1, middle.x - side / 2, middle.y - side / 2, side));
  }
  double minSide(const cv::Size&) const override { return 0; }
  BorderSquare border(const MarkerKey&) const override { return {}; }

  std::vector<cv::Rect> windows;
};

TEST(MarkerSearch, QuadsInsideOfAMarkerAreNotLookedAt) {
  cv::Mat image(480, 640, CV_8U, cv::Scalar(200));
  for (const cv::Rect& square : {cv::Rect(100, 100, 120, 120), {400, 200, 80, 80}})
    cv::rectangle(image, square, cv::Scalar(30), cv::FILLED);
  cv::rectangle(image, {140, 140, 40, 40}, cv::Scalar(200), cv::FILLED);
  QuadSearch quads;
  quads.find(image, {{0, 0}, image.size()}, 12, Effort::thorough);
  ASSERT_GE(quads.distinct().size(), 3u);
  Windows search;
  FoundMarkers found;
  search.inside(image, quads, Effort::thorough, found);
  ASSERT_EQ(search.windows.size(), 2u);
  EXPECT_TRUE(search.windows[0].contains({160, 160}));
  EXPECT_TRUE(search.windows[1].contains({440, 240}));
}

}  // namespace
}  // namespace sextant
