// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>

#include "sextant/detection/marker_detector.hpp"
#include "sextant/markers/marker_family.hpp"
#include "test_print.hpp"

namespace sextant {
namespace {

const cv::Size kImage = {480, 270};

// The print, somewhat turned.
Corners place(const Eigen::Vector2d& middle, double side) {
  const Eigen::Vector2d right(0.5 * side, 0.08 * side), down(-0.06 * side, 0.5 * side);
  return {middle - right - down, middle + right - down, middle + right + down, middle - right + down};
}

cv::Mat view(const Eigen::Vector2d& middle, double side, int seed, const std::string& family = "tag36h11") {
  Exposure exposure;
  exposure.size = kImage;
  exposure.seed = seed;
  exposure.supersampling = 3;
  return photograph(printScene(place(middle, side), family), exposure);
}

// The mean of the images along a motion by this many pixels.
cv::Mat motionBlurred(const cv::Mat& image, int length, double angle) {
  cv::Mat sum(image.size(), CV_32F, cv::Scalar(0)), moved, blurred;
  for (int i = 0; i <= length; ++i) {
    const double by = i - 0.5 * length;
    const cv::Matx23d shift(1, 0, by * std::cos(angle), 0, 1, by * std::sin(angle));
    cv::warpAffine(image, moved, shift, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::add(sum, moved, sum, cv::noArray(), CV_32F);
  }
  sum.convertTo(blurred, CV_8U, 1.0 / (length + 1));
  return blurred;
}

cv::Mat empty() { return view({-500, -500}, 50, 1); }

std::unique_ptr<MarkerDetector> detector(const std::string& family, const std::string& search) {
  DetectorParams params;
  params.families = {family};
  params.search = search;
  return makeMarkerDetector(params);
}

class Tracking : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<MarkerDetector> tracking_ = detector(GetParam(), "tracking");
  std::unique_ptr<MarkerDetector> full_ = detector(GetParam(), "full");

  static cv::Mat view(const Eigen::Vector2d& middle, double side, int seed) {
    return sextant::view(middle, side, seed, GetParam());
  }

  static double farthest(const Corners& a, const Corners& b) {
    double most = 0;
    for (int i = 0; i < 4; ++i) most = std::max(most, (a[i] - b[i]).norm());
    return most;
  }
};

TEST_P(Tracking, SeesWhatAFullSearchSees) {
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d middle(60 + 25 * i + 2 * (i % 3), 135 + 40 * std::sin(0.5 * i));
    const cv::Mat image = view(middle, 40 + 3 * i, i);
    const auto tracked = tracking_->detect(image), all = full_->detect(image);
    ASSERT_EQ(tracked.size(), 1u) << i;
    ASSERT_EQ(all.size(), 1u) << i;
    EXPECT_LT(farthest(tracked[0].corners, all[0].corners), 0.1) << i;
    EXPECT_LT(farthest(tracked[0].corners, place(middle, 40 + 3 * i)), 0.2) << i;
  }
}

// Its white is cut off by the border, as of one that comes into view.
TEST_P(Tracking, SeesALargeOneBesideTheBorder) {
  const auto families = markerFamilies();
  const bool is_old = std::count(families.begin(), families.end(), "tag36h10") == 0;  // libapriltag 0.10
  const double side = 130;
  for (int gap = is_old ? 6 : 5; gap <= 14; ++gap) {
    const Eigen::Vector2d middle(kImage.width - gap - 0.53 * side, 135);
    tracking_->detect(view(middle - Eigen::Vector2d(8, 0), side, gap));
    const auto found = tracking_->detect(view(middle, side, 100 + gap));
    ASSERT_EQ(found.size(), 1u) << gap;
    EXPECT_LT(farthest(found[0].corners, place(middle, side)), 0.2) << gap;
  }
}

TEST_P(Tracking, FindsOneThatComesAnywhereWithinThreeImages) {
  for (const Eigen::Vector2d& middle : {Eigen::Vector2d(50, 50), {240, 135}, {430, 220}}) {
    tracking_->detect(empty());
    int images = 1;
    while (images <= 3 && tracking_->detect(view(middle, 50, images)).empty()) ++images;
    EXPECT_LE(images, 3) << middle.transpose();
    for (int i = 0; i < 8; ++i) tracking_->detect(empty());
  }
}

TEST_P(Tracking, FindsOneAtOnceThatJumpedAway) {
  tracking_->detect(view({80, 80}, 50, 1));
  tracking_->detect(view({82, 80}, 50, 2));
  const auto found = tracking_->detect(view({400, 190}, 60, 3));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(farthest(found[0].corners, place({400, 190}, 60)), 0.2);
}

TEST_P(Tracking, SeesItAgainAfterABlankImage) {
  for (int i = 0; i < 3; ++i) tracking_->detect(view({200 + 5.0 * i, 130}, 50, i));
  EXPECT_TRUE(tracking_->detect(empty()).empty());
  EXPECT_EQ(tracking_->detect(view({220, 130}, 50, 9)).size(), 1u);
}

TEST_P(Tracking, SearchesEverywhereWhenTheImageHasAnotherSize) {
  tracking_->detect(empty());
  const cv::Mat image = view({100, 100}, 50, 1)(cv::Rect(0, 0, 320, 240));
  EXPECT_EQ(tracking_->detect(image).size(), 1u);
  EXPECT_EQ(tracking_->detect(view({300, 100}, 50, 1)).size(), 1u);
}

// A contrast of eight grey levels.
TEST_P(Tracking, SeesInPoorLight) {
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector2d middle(120 + 10 * i, 130);
    cv::Mat dark = view(middle, 60, i);
    dark.convertTo(dark, CV_8U, 0.05);
    EXPECT_EQ(tracking_->detect(dark).size(), 1u) << i;
    EXPECT_EQ(full_->detect(dark).size(), 1u) << i;
  }
}

// A contrast of 15 grey levels on a bright wall.
TEST_P(Tracking, FindsAFaintOneWithin30Images) {
  tracking_->detect(empty());
  int images = 0;
  bool is_found = false;
  while (!is_found && ++images <= 30) {
    cv::Mat faint = view({240 + 0.2 * images, 135}, 34, images);
    faint.convertTo(faint, CV_8U, 0.1, 200);
    is_found = !tracking_->detect(faint).empty();
  }
  EXPECT_TRUE(is_found);
  EXPECT_GT(images, 3);  // it is too faint for a quick search
}

// 12 pixels, as wide as two of its modules, in four directions.
TEST_P(Tracking, SeesWhatMotionBlurs) {
  for (int direction = 0; direction < 4; ++direction) {
    const Eigen::Vector2d middle(240, 135);
    for (int i = 0; i < 3; ++i) tracking_->detect(view(middle, 50, i));
    const cv::Mat image = motionBlurred(view(middle, 50, 9), 12, direction * M_PI / 4);
    EXPECT_EQ(tracking_->detect(image).size(), 1u) << direction;
    const auto found = full_->detect(image);
    ASSERT_EQ(found.size(), 1u) << direction;
    EXPECT_EQ(found[0].key, (MarkerKey{GetParam(), 9}));
    EXPECT_LT(farthest(found[0].corners, place(middle, 50)), 6) << direction;
  }
}

TEST_P(Tracking, SeesOneWithACornerOutside) {
  const Eigen::Vector2d middle(27, 135);  // its left corners at x = -1 and 2
  EXPECT_EQ(full_->detect(view(middle + Eigen::Vector2d(20, 0), 50, 1)).size(), 1u);
  const auto found = full_->detect(view(middle, 50, 2));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(farthest(found[0].corners, place(middle, 50)), 0.5);
}

INSTANTIATE_TEST_SUITE_P(Backends, Tracking, testing::Values("tag36h11", "DICT_6X6_250"),
                         [](const auto& info) { return info.param; });

// Records the regions in which it was asked to search.
class Watched : public MarkerSearch {
 public:
  void everywhere(const cv::Mat&, FoundMarkers& found) override {
    ++searches;
    if (there) found.add(*there);
    for (const Detection& other : others) found.add(other);
  }
  void within(const cv::Mat& image, const cv::Rect& window, double, Effort, FoundMarkers& found) override {
    EXPECT_EQ(window & cv::Rect({0, 0}, image.size()), window);
    ++windows;
    if (there) found.add(*there);
  }
  bool readAt(const cv::Mat&, Detection&) override { return in_place; }
  bool readsInPlace() const override { return in_place; }
  double minSide(const cv::Size&) const override { return 12; }
  BorderSquare border(const MarkerKey&) const override { return {}; }
  int searches = 0, windows = 0;
  bool in_place = false;
  std::optional<Detection> there;
  std::vector<Detection> others;  // that only a full search finds
};

// A full search with decimate 2 finds a tag of 24 pixels.
TEST(MarkerTracker, FindsSmallTagsInAReducedImage) {
  DetectorParams params;
  params.decimate = 2;
  params.search = "tracking";
  const auto tracking = makeMarkerDetector(params);
  tracking->detect(empty());
  for (int i = 0; i < 6; ++i) {
    const auto found = tracking->detect(view({100 + 9.0 * i, 130}, 25, i));
    EXPECT_EQ(found.size(), i < 2 ? found.size() : 1u) << i;
  }
}

TEST(MarkerTracker, DoesNotSearchAnEmptyViewAgainAndAgain) {
  auto search = std::make_unique<Watched>();
  const Watched& watched = *search;
  MarkerTracker tracker(std::move(search), true, true);
  for (int i = 0; i < 10; ++i) tracker.find(cv::Mat(kImage, CV_8UC1, cv::Scalar(128)), nullptr);
  EXPECT_EQ(watched.searches, 1);
  EXPECT_EQ(watched.windows, 0);
}

// Once it is known how it moves, its edges and its code are enough, but for the sweeps.
TEST(MarkerTracker, LooksForNoMarkerThatItReadsInPlace) {
  for (const bool in_place : {false, true}) {
    auto search = std::make_unique<Watched>();
    Watched& watched = *search;
    watched.in_place = in_place;
    MarkerTracker tracker(std::move(search), true, true);
    for (int i = 0; i < 9; ++i) {
      const Eigen::Vector2d middle(120 + 10 * i, 130 + 3 * i);
      watched.there = Detection{{"tag36h11", 9}, place(middle, 60), {0.5, 0.5, 0.5, 0.5}};
      const auto found = tracker.find(view(middle, 60, i), nullptr);
      ASSERT_EQ(found.size(), 1u) << i;
      for (int k = 0; k < 4; ++k)
        EXPECT_LT((found[0].corners[k] - watched.there->corners[k]).norm(), 0.15) << i;
      if (i == 1) watched.windows = 0;
    }
    if (in_place)
      EXPECT_EQ(watched.windows, 0);
    else
      EXPECT_GE(watched.windows, 7);
  }
}

// A corner may lie outside, where its edges meet, but no edge: a module has 6 pixels.
TEST(MarkerTracker, ReportsNoMarkerThatGoesOnOutsideTheImage) {
  for (const auto& [x, count] : {std::pair(100.0, 1u), {26.0, 1u}, {21.0, 0u}}) {
    auto search = std::make_unique<Watched>();
    search->there = Detection{{"tag36h11", 9}, place({x, 130}, 50), {0.5, 0.5, 0.5, 0.5}};
    MarkerTracker tracker(std::move(search), true, false);
    EXPECT_EQ(tracker.find(empty(), nullptr).size(), count) << x;
  }
}

// The windows of forty lost markers are larger than the image.
TEST(MarkerTracker, SearchesTheImageOnceWhereItLostMany) {
  auto search = std::make_unique<Watched>();
  Watched& watched = *search;
  for (int id = 0; id < 40; ++id)
    watched.others.push_back(Detection{
        {"tag36h11", id}, place({40.0 + 57 * (id % 8), 30.0 + 52 * (id / 8)}, 40), {0.5, 0.5, 0.5, 0.5}});
  MarkerTracker tracker(std::move(search), true, false);
  for (int i = 0; i < 2; ++i) tracker.find(empty(), nullptr);
  EXPECT_EQ(watched.searches, 2);
  EXPECT_EQ(watched.windows, 0);
}

TEST(MarkerTracker, SearchesEveryImageWhereItIsNotToTrack) {
  auto search = std::make_unique<Watched>();
  const Watched& watched = *search;
  MarkerTracker tracker(std::move(search), false, true);
  for (int i = 0; i < 4; ++i) tracker.find(cv::Mat(kImage, CV_8UC1, cv::Scalar(128)), nullptr);
  EXPECT_EQ(watched.searches, 4);
}

}  // namespace
}  // namespace sextant
