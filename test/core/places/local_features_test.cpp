// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/local_features.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <map>
#include <opencv2/features2d.hpp>
#include <stdexcept>
#include <tuple>

#include "test_blobs.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

using Pair = std::pair<std::string, std::string>;  // detector, extractor

std::vector<Pair> allPairs() {
  std::vector<Pair> pairs;
  for (const std::string& detector : featureNames())
    for (const std::string& extractor : featureNames())
      if (extractor != "AKAZE" || detector == "AKAZE") pairs.emplace_back(detector, extractor);
  return pairs;
}

FeatureParams paramsOf(const Pair& pair) {
  FeatureParams params;
  std::tie(params.detector, params.extractor) = pair;
  return params;
}

/// All keypoints at their own size.
FeatureParams fullSize(const Pair& pair) {
  FeatureParams params = paramsOf(pair);
  params.max_features = pair.first == "ORB" || pair.second == "ORB" ? 2000 : 0;
  params.support_scale = 1;
  return params;
}

const cv::Size kSize(320, 320);

cv::Mat testImage(const Similarity& T_image_scene = {}) {
  return blobImage(randomScene(), kSize, T_image_scene);
}

Agreement matchWith(const FeatureParams& params, const Similarity& T_image_scene) {
  const FeatureExtractor extractor(params);
  return agreement(extractor.extract(testImage()), extractor.extract(testImage(T_image_scene)),
                   T_image_scene);
}

void expectSame(const LocalFeatures& a, const LocalFeatures& b) {
  ASSERT_EQ(a.keypoints.size(), b.keypoints.size());
  for (size_t i = 0; i < a.keypoints.size(); ++i) {
    EXPECT_EQ(a.keypoints[i].pt, b.keypoints[i].pt);
    EXPECT_EQ(a.keypoints[i].size, b.keypoints[i].size);
    EXPECT_EQ(a.keypoints[i].angle, b.keypoints[i].angle);
  }
  EXPECT_EQ(cv::norm(a.descriptors, b.descriptors, cv::NORM_INF), 0);
}

/// ORB's keypoints are as large as its patch: SIFT and SURF would describe most of the image.
bool seesTooMuch(const Pair& pair) {
  return pair.first == "ORB" && (pair.second == "SIFT" || pair.second == "SURF");
}

TEST(LocalFeatures, EveryPairMatchesAShiftedImage) {
  for (const Pair& pair : allPairs()) {
    SCOPED_TRACE(pair.first + " " + pair.second);
    const Agreement found = matchWith(fullSize(pair), {1, 0, {3.4, -2.3}});
    EXPECT_GT(found.repeated, 0.75);
    EXPECT_GT(found.matched, seesTooMuch(pair) ? 0.4 : 0.75);
    EXPECT_LT(cv::norm(found.bias), 0.1);
  }
}

TEST(LocalFeatures, EveryPairMatchesAnEnlargedImage) {
  for (const Pair& pair : allPairs()) {
    SCOPED_TRACE(pair.first + " " + pair.second);
    const Agreement found = matchWith(fullSize(pair), aboutPoint({160, 160}, 1.4, 0));
    EXPECT_GT(found.repeated, 0.5);
    EXPECT_GT(found.matched, seesTooMuch(pair) ? 0.1 : 0.6);
    EXPECT_LT(cv::norm(found.bias), 0.3);  // OpenCV's SIFT has a bias of a quarter of a pixel
  }
}

TEST(LocalFeatures, OnlyOrientedFeaturesMatchARotatedImage) {
  for (const std::string& name : featureNames())
    for (const bool upright : {true, false}) {
      SCOPED_TRACE(name + (upright ? ", upright" : ""));
      FeatureParams params = fullSize({name, name});
      params.upright = upright;
      const Agreement found = matchWith(params, aboutPoint({160, 160}, 1, 2.1));
      EXPECT_GT(found.repeated, 0.65);
      if (upright)
        EXPECT_LT(found.matched, 0.1);
      else
        EXPECT_GT(found.matched, 0.55);
    }
}

cv::KeyPoint strongest(const std::string& detector, int max_side, const cv::Mat& image) {
  FeatureParams params = paramsOf({detector, "SIFT"});
  params.max_side = max_side;
  params.max_features = 1;
  return FeatureExtractor(params).extract(image).keypoints.at(0);
}

TEST(LocalFeatures, LocatesABlobAndItsSize) {
  const Blob blob{{700.3, 200.6}, 9, 100};
  const cv::Mat image = blobImage({blob}, {1000, 400});
  const auto expect = [&](const cv::KeyPoint& point, double size, double max_offset) {
    EXPECT_LT(cv::norm(cv::Point2d(point.pt) - blob.centre), max_offset);
    EXPECT_NEAR(point.size / blob.sigma, size, 0.05 * size);
  };
  // The difference of the Gaussians of sigma and k sigma is extreme at sigma = blob.sigma / sqrt(k), k =
  // 2^(1/3). OpenCV 4.6 has a bias of a quarter of a pixel in x and y.
  const double sift = 2 / std::pow(2, 1.0 / 6);
  expect(strongest("SIFT", 0, image), sift, 0.4);
  expect(strongest("SIFT", 500, image), sift, 0.8);
  // SURF's boxes, of which the middle one is r blob.sigma wide, say erf(r / sqrt 2) (3 erf(r / sqrt 8) -
  // erf(3 r / sqrt 8)) / r^2: most at r = 1.70. It is a third of the filter, which is 9 wide at scale 1.2.
  const double surf = 2 * 1.2 / 9 * 3 * 1.70;
  expect(strongest("SURF", 0, image), surf, 0.1);
  expect(strongest("SURF", 500, image), surf, 0.2);
}

TEST(LocalFeatures, CompensatesForRoundedSidesOfAReducedImage) {
  const cv::Point2d centre(700.3, 110.3);
  const cv::Mat image = blobImage({{centre, 9, 100}}, {1000, 145});  // 46.4 rows for 320 columns
  const cv::Point2d off = cv::Point2d(strongest("SIFT", 320, image).pt) - centre;
  EXPECT_NEAR(off.x, off.y, 0.2);
}

TEST(LocalFeatures, PlainProfileEqualsOpenCv) {
  const std::map<std::string, cv::Ptr<cv::Feature2D>> all = {
      {"SIFT", cv::SIFT::create()}, {"ORB", cv::ORB::create()}, {"AKAZE", cv::AKAZE::create()}};
  for (const auto& [name, opencv] : all) {
    SCOPED_TRACE(name);
    LocalFeatures expected;
    opencv->detectAndCompute(testImage(), cv::noArray(), expected.keypoints, expected.descriptors);
    expectSame(FeatureExtractor(FeatureParams::plain(name, name)).extract(testImage()), expected);
  }
}

TEST(LocalFeatures, RootSiftIsTheRootOfTheNormalizedDescriptor) {
  FeatureParams params;
  const LocalFeatures root = FeatureExtractor(params).extract(testImage());
  params.root_sift = false;
  const LocalFeatures plain = FeatureExtractor(params).extract(testImage());
  ASSERT_EQ(root.descriptors.size(), plain.descriptors.size());
  for (int i = 0; i < plain.descriptors.rows; ++i) {
    const double sum = cv::sum(plain.descriptors.row(i))[0];
    for (int j = 0; j < 128; ++j)
      EXPECT_NEAR(root.descriptors.at<float>(i, j),
                  std::min(255.0, 512 * std::sqrt(plain.descriptors.at<float>(i, j) / sum)), 0.501);
  }
}

// Images larger than half of max_side are described one octave up.
TEST(LocalFeatures, DescriptorsOneOctaveUpAreSimilar) {
  for (const char* detector : {"SIFT", "SURF"}) {
    FeatureParams params = paramsOf({detector, "SIFT"});
    params.max_side = 2 * kSize.width;
    const LocalFeatures exact = FeatureExtractor(params).extract(testImage());
    params.max_side = kSize.width;
    const LocalFeatures quick = FeatureExtractor(params).extract(testImage());
    ASSERT_EQ(quick.descriptors.size(), exact.descriptors.size());
    int same = 0;
    for (int i = 0; i < quick.descriptors.rows; ++i)
      same += nearestDescriptor(quick.descriptors.row(i), exact.descriptors) == i;
    EXPECT_GT(same, 0.8 * quick.descriptors.rows);
    EXPECT_GT(cv::norm(quick.descriptors, exact.descriptors), 0);
  }
}

TEST(LocalFeatures, EveryPairReturnsOneRowPerKeypoint) {
  const std::map<std::string, cv::Mat> kinds = {{"AKAZE", cv::Mat(0, 61, CV_8U)},
                                                {"ORB", cv::Mat(0, 32, CV_8U)},
                                                {"SIFT", cv::Mat(0, 128, CV_32F)},
                                                {"SURF", cv::Mat(0, 64, CV_32F)}};
  for (const Pair& pair : allPairs()) {
    SCOPED_TRACE(pair.first + " " + pair.second);
    const cv::Mat& kind = kinds.at(pair.second);
    EXPECT_EQ(isBinaryExtractor(pair.second), kind.type() == CV_8U);
    const FeatureExtractor extractor(fullSize(pair));
    const auto expect = [&](const cv::Mat& image, bool something) {
      const LocalFeatures found = extractor.extract(image);
      EXPECT_EQ(found.size, image.size());
      EXPECT_EQ(found.keypoints.size(), found.descriptors.rows);
      EXPECT_EQ(found.descriptors.rows > 0, something) << image.size();
      EXPECT_EQ(found.descriptors.cols, kind.cols);
      EXPECT_EQ(found.descriptors.type(), kind.type());
    };
    expect(testImage(), true);
    expect(cv::Mat(240, 320, CV_8U, cv::Scalar(90)), false);
    for (const cv::Size& tiny : {cv::Size(1, 1), cv::Size(3, 400), cv::Size(50, 1), cv::Size(9, 9)})
      expect(cv::Mat(tiny, CV_8U, cv::Scalar(90)), false);
  }
}

// For the address sanitizer: no support region, small or large, reads outside the image.
TEST(LocalFeatures, SurfDescribesSiftKeypointsAtEverySupportScale) {
  FeatureParams params = paramsOf({"SIFT", "SURF"});
  params.max_features = 250;
  for (const double support : {0.01, 0.3, 1.0, 2.0}) {
    params.support_scale = support;
    const LocalFeatures found = FeatureExtractor(params).extract(testImage());
    EXPECT_EQ(found.descriptors.rows, params.max_features);
    EXPECT_TRUE(cv::checkRange(found.descriptors));
  }
}

TEST(LocalFeatures, KeepsTheStrongestKeypoints) {
  for (const char* name : {"AKAZE", "SIFT", "SURF"}) {
    SCOPED_TRACE(name);
    FeatureParams params = fullSize({name, name});
    std::vector<float> responses;
    for (const auto& point : FeatureExtractor(params).extract(testImage()).keypoints)
      responses.push_back(point.response);
    std::sort(responses.rbegin(), responses.rend());
    params.max_features = 20;
    const auto strongest = FeatureExtractor(params).extract(testImage()).keypoints;
    ASSERT_EQ(strongest.size(), 20);
    for (size_t i = 0; i < 20; ++i) EXPECT_EQ(strongest[i].response, responses[i]);
  }
}

TEST(LocalFeatures, ExtractorIsThreadSafe) {
  for (const std::string& name : featureNames()) {
    const FeatureExtractor extractor(paramsOf({name, name}));
    std::vector<std::future<LocalFeatures>> all(4);
    for (auto& each : all)
      each = std::async(std::launch::async, [&] { return extractor.extract(testImage()); });
    const LocalFeatures alone = extractor.extract(testImage());
    for (auto& each : all) expectSame(each.get(), alone);
  }
}

TEST(LocalFeatures, RejectsInvalidArguments) {
  const FeatureExtractor extractor((FeatureParams()));
  for (const cv::Mat& image : {cv::Mat(), cv::Mat(9, 9, CV_8UC3), cv::Mat(9, 9, CV_16U)})
    EXPECT_EQ(refusal<std::invalid_argument>([&] { extractor.extract(image); }),
              "FeatureExtractor: the image must be 8-bit grey and not empty");
  for (const char* detector : {"ORB", "SIFT", "SURF"})
    EXPECT_EQ(refusal<std::invalid_argument>([&] {
                FeatureExtractor(paramsOf({detector, "AKAZE"}));
              }),
              std::string("extractor AKAZE needs detector AKAZE, it is ") + detector);
  EXPECT_EQ(refusal<std::invalid_argument>([] {
              validate(paramsOf({"FAST", "SIFT"}));
            }),
            "detector is 'FAST', it must be one of AKAZE, ORB, SIFT, SURF");
  EXPECT_EQ(refusal<std::invalid_argument>([] {
              validate(paramsOf({"SIFT", "BRIEF"}));
            }),
            "extractor is 'BRIEF', it must be one of AKAZE, ORB, SIFT, SURF");
  EXPECT_EQ(refusal<std::invalid_argument>([] { isBinaryExtractor("BRIEF"); }),
            "extractor is 'BRIEF', it must be one of AKAZE, ORB, SIFT, SURF");
}

TEST(LocalFeatures, NamesParametersOutOfRange) {
  const std::vector<std::pair<std::string, std::function<void(FeatureParams&)>>> bad = {
      {"max_side is -1, allowed is [0, 16384] px", [](auto& p) { p.max_side = -1; }},
      {"max_side is 16385, allowed is [0, 16384] px", [](auto& p) { p.max_side = 16385; }},
      {"max_features is -1, allowed is [0, 1000000]", [](auto& p) { p.max_features = -1; }},
      {"support_scale is 0, allowed is (0, 16]", [](auto& p) { p.support_scale = 0; }},
      {"support_scale is 17, allowed is (0, 16]", [](auto& p) { p.support_scale = 17; }},
      {"sift_contrast is 0, allowed is (0, 1]", [](auto& p) { p.sift_contrast = 0; }},
      {"surf_threshold is -3, allowed is (0, 1000000]", [](auto& p) { p.surf_threshold = -3; }},
      {"akaze_threshold is 2, allowed is (0, 1]", [](auto& p) { p.akaze_threshold = 2; }},
      {"orb_wta_k is 1, allowed is [2, 4]", [](auto& p) { p.orb_wta_k = 1; }},
      {"orb_wta_k is 5, allowed is [2, 4]", [](auto& p) { p.orb_wta_k = 5; }},
  };
  for (const auto& [message, spoil] : bad) {
    FeatureParams params;
    spoil(params);
    EXPECT_EQ(refusal<std::invalid_argument>([&] { validate(params); }), message);
    EXPECT_EQ(refusal<std::invalid_argument>([&] { FeatureExtractor extractor(params); }), message);
  }
  EXPECT_EQ(refusal<std::invalid_argument>([] { validate(FeatureParams()); }), "accepted");
  for (const Pair& pair : allPairs())
    EXPECT_EQ(
        refusal<std::invalid_argument>([&] { validate(FeatureParams::plain(pair.first, pair.second)); }),
        "accepted");
}

}  // namespace
}  // namespace sextant
