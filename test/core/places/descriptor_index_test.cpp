// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/descriptor_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <map>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "test_descriptors.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

/// Hamming distance over pairs of bits.
double pairsThatDiffer(const cv::Mat& a, const cv::Mat& b) {
  int count = 0;
  for (int i = 0; i < a.cols; ++i)
    for (int shift = 0; shift < 8; shift += 2) count += ((a.at<uchar>(i) ^ b.at<uchar>(i)) >> shift & 3) != 0;
  return count;
}

using Distance = std::function<double(const cv::Mat&, const cv::Mat&)>;

Distance distanceOf(const std::string& matcher, int type) {
  if (matcher == "BruteForce-Hamming(2)") return pairsThatDiffer;
  const int norm = matcher == "BruteForce-L1" ? cv::NORM_L1 : type == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2;
  return [norm](const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, norm); };
}

std::vector<double> nearestDistances(const Descriptors& all, const cv::Mat& query, int k,
                                     const Distance& distance) {
  std::vector<double> distances;
  for (const auto& [image_id, descriptors] : all)
    for (int row = 0; row < descriptors.rows; ++row)
      distances.push_back(distance(query, descriptors.row(row)));
  std::sort(distances.begin(), distances.end());
  distances.resize(k);
  return distances;
}

/// Share of the true neighbours that are found. Checks that the reported distances are true within a
/// tolerance.
double recall(const DescriptorIndex& index, const Descriptors& all, const cv::Mat& queries, int k,
              const Distance& distance, double tolerance) {
  const Neighbours found = index.search(queries, k);
  int right = 0;
  for (int query = 0; query < queries.rows; ++query) {
    const auto truth = nearestDistances(all, queries.row(query), k, distance);
    for (int i = query * k; i < (query + 1) * k; ++i) {
      if (found.image_ids[i] < 0) continue;
      const double there = distance(queries.row(query), all.at(found.image_ids[i]).row(found.rows[i]));
      EXPECT_NEAR(found.distances[i], there, tolerance * there + 1e-3);
      right += there <= truth.back();
      EXPECT_GE(found.distances[i], found.distances[std::max(i - 1, query * k)]);
    }
  }
  return static_cast<double>(right) / (queries.rows * k);
}

TEST(DescriptorIndex, BruteForceFindsTheNearestNeighbours) {
  for (const MatcherCase& each : matcherCases()) {
    if (each.matcher == "faiss" || each.matcher == "FlannBased") continue;
    SCOPED_TRACE(each.matcher);
    const Descriptors all = imageDescriptors(20, each.width, each.type);
    const cv::Mat queries = randomDescriptors(20, each.width, each.type, 1000);
    const auto index = indexOf(each.matcher, all);
    EXPECT_EQ(recall(*index, all, queries, 7, distanceOf(each.matcher, each.type), 1e-6), 1);
  }
}

TEST(DescriptorIndex, FlannIsReproducible) {
  const Descriptors all = imageDescriptors(40, 32, CV_32F);
  const cv::Mat queries = randomDescriptors(100, 32, CV_32F, 1000);
  const std::vector<int32_t> first = indexOf("FlannBased", all)->search(queries, 3).rows;
  cv::theRNG().next();
  EXPECT_EQ(indexOf("FlannBased", all)->search(queries, 3).rows, first);
}

TEST(DescriptorIndex, EveryMatcherFindsSimilarDescriptors) {
  for (const MatcherCase& each : matcherCases()) {
    SCOPED_TRACE(each.matcher + std::to_string(each.width));
    const Descriptors all = imageDescriptors(40, each.width, each.type);
    const auto index = indexOf(each.matcher, all);
    const Distance distance = distanceOf(each.matcher, each.type);
    const cv::Mat queries = similarTo(all).rowRange(0, 60);
    EXPECT_GT(recall(*index, all, queries, 1, distance, 0.05), 0.98);
    EXPECT_GT(recall(*index, all, queries, 3, distance, 0.05), 0.6);
    EXPECT_EQ(index->size(), together(all).rows);
  }
}

TEST(DescriptorIndex, RemovesTheDescriptorsOfOneImage) {
  for (const MatcherCase& each : matcherCases()) {
    SCOPED_TRACE(each.matcher + std::to_string(each.width));
    Descriptors all = imageDescriptors(20, each.width, each.type);
    const cv::Mat queries = similarTo(all);
    const auto index = indexOf(each.matcher, all);
    const auto found = index->search(queries, 1);
    for (const int32_t image_id : {0, 10, 19}) {
      all.erase(image_id);
      index->remove(image_id);
    }
    for (const int32_t stranger : {20, -1, std::numeric_limits<int32_t>::max()}) index->remove(stranger);
    EXPECT_EQ(index->size(), together(all).rows);
    const auto kept = index->search(queries, 1);
    for (int i = 0; i < queries.rows; ++i) {
      EXPECT_TRUE(all.count(kept.image_ids[i]));
      if (!all.count(found.image_ids[i])) continue;
      EXPECT_EQ(kept.image_ids[i], found.image_ids[i]);
      EXPECT_EQ(kept.rows[i], found.rows[i]);
      EXPECT_EQ(kept.distances[i], found.distances[i]);
    }
    const cv::Mat back = randomDescriptors(5, each.width, each.type, 77);
    index->add(10, back);
    EXPECT_EQ(index->search(back, 1).image_ids, std::vector<int32_t>(5, 10));
    EXPECT_EQ(index->search(back, 1).rows, (std::vector<int32_t>{0, 1, 2, 3, 4}));
  }
}

TEST(DescriptorIndex, ReportsMissingNeighbours) {
  for (const MatcherCase& each : matcherCases()) {
    SCOPED_TRACE(each.matcher + std::to_string(each.width));
    const cv::Mat two = randomDescriptors(2, each.width, each.type, 1);
    const auto index = makeDescriptorIndex(each.matcher, two, 2);
    const float inf = std::numeric_limits<float>::infinity();
    const Neighbours none = index->search(two, 1);
    EXPECT_EQ(none.image_ids, (std::vector<int32_t>{-1, -1}));
    EXPECT_EQ(none.rows, (std::vector<int32_t>{-1, -1}));
    EXPECT_EQ(none.distances, (std::vector<float>{inf, inf}));
    index->add(7, two.row(1));
    index->add(2, two.row(0));
    index->add(3, two.rowRange(0, 0));
    const Neighbours found = index->search(two.row(1), 4);
    EXPECT_EQ(found.image_ids, (std::vector<int32_t>{7, 2, -1, -1}));
    EXPECT_EQ(found.rows, (std::vector<int32_t>{0, 0, -1, -1}));
    EXPECT_LT(found.distances[0], found.distances[1]);
    EXPECT_TRUE(std::isfinite(found.distances[1]));
    EXPECT_EQ(found.distances[2], inf);
    EXPECT_TRUE(index->search(cv::Mat(), 4).image_ids.empty());
  }
}

// OpenCV's brute force is limited to 8191 matrices of fewer than 2^18 rows.
TEST(DescriptorIndex, BruteForceTakesManyImagesWithManyDescriptors) {
  const cv::Mat every = randomDescriptors(300000, 4, CV_8U, 1);
  const auto index = makeDescriptorIndex("BruteForce-Hamming", every, every.rows);
  constexpr int kRows = 30;
  for (int image_id = 0; image_id * kRows < every.rows; ++image_id)
    index->add(image_id, every.rowRange(image_id * kRows, (image_id + 1) * kRows));
  for (const int row : {0, 150007, 299999}) {
    const Neighbours found = index->search(every.row(row), 1);
    EXPECT_EQ(found.distances[0], 0);
    const int there = found.image_ids[0] * kRows + found.rows[0];
    EXPECT_EQ(cv::norm(every.row(there), every.row(row), cv::NORM_HAMMING), 0);
  }
}

TEST(DescriptorIndex, SearchIsThreadSafe) {
  for (const MatcherCase& each : matcherCases()) {
    SCOPED_TRACE(each.matcher + std::to_string(each.width));
    const Descriptors all = imageDescriptors(20, each.width, each.type);
    const cv::Mat queries = similarTo(all);
    const auto index = indexOf(each.matcher, all);
    std::vector<std::future<Neighbours>> found(4);
    for (auto& some : found) some = std::async(std::launch::async, [&] { return index->search(queries, 3); });
    const Neighbours alone = index->search(queries, 3);
    for (auto& some : found) expectSame(some.get(), alone);
  }
}

TEST(DescriptorIndex, AcceptsMatchersThatFitTheExtractor) {
  const std::map<std::pair<std::string, int>, std::string> allowed = {
      {{"SIFT", 2}, "BruteForce, BruteForce-L1, FlannBased, faiss"},
      {{"SURF", 3}, "BruteForce, BruteForce-L1, FlannBased, faiss"},
      {{"AKAZE", 4}, "BruteForce-Hamming, faiss"},
      {{"ORB", 2}, "BruteForce-Hamming, faiss"},
      {{"ORB", 3}, "BruteForce-Hamming(2)"},
      {{"ORB", 4}, "BruteForce-Hamming(2)"}};
  for (const auto& [made, names] : allowed) {
    const auto& [extractor, orb_wta_k] = made;
    for (const std::string& matcher : matcherNames()) {
      const auto validate = [&, &e = extractor, &w = orb_wta_k] { validateMatcher(matcher, e, w); };
      const bool fits = (", " + names + ",").find(", " + matcher + ",") != std::string::npos;
      const std::string pairs = extractor == "ORB" && orb_wta_k > 2 ? " with orb_wta_k 3 or 4" : "";
      EXPECT_EQ(refusal<std::invalid_argument>(validate), fits ? "accepted"
                                                               : "matcher is '" + matcher +
                                                                     "', for extractor " + extractor + pairs +
                                                                     " it must be one of " + names);
    }
  }
  EXPECT_EQ(refusal<std::invalid_argument>([] { validateMatcher("Flann", "ORB", 3); }),
            "matcher is 'Flann', for extractor ORB with orb_wta_k 3 or 4 it must be one of "
            "BruteForce-Hamming(2)");
  EXPECT_NE(refusal<std::invalid_argument>([] { validateMatcher("faiss", "BRIEF", 2); }).find("'BRIEF'"),
            std::string::npos);
}

TEST(DescriptorIndex, RejectsInvalidArguments) {
  const cv::Mat numbers = randomDescriptors(50, 64, CV_32F, 1), bits = randomDescriptors(50, 32, CV_8U, 1);
  const auto refused = [](const std::string& matcher, const cv::Mat& samples, int64_t expected) {
    return refusal<std::invalid_argument>([&] { makeDescriptorIndex(matcher, samples, expected); });
  };
  EXPECT_EQ(refused("Flann", numbers, 1), "unknown matcher 'Flann'");
  EXPECT_EQ(refused("faiss", cv::Mat(), 1), "a descriptor index needs sample descriptors");
  EXPECT_EQ(refused("faiss", numbers, -1), "the expected number of descriptors is negative");
  EXPECT_EQ(refused("faiss", cv::Mat(9, 64, CV_64F), 1),
            "matcher 'faiss' cannot compare descriptors of type CV_64FC1, 64 wide");
  EXPECT_EQ(refused("BruteForce", bits, 1),
            "matcher 'BruteForce' cannot compare descriptors of type CV_8UC1, 32 wide");
  EXPECT_EQ(refused("BruteForce-Hamming", numbers, 1),
            "matcher 'BruteForce-Hamming' cannot compare descriptors of type CV_32FC1, 64 wide");
  for (const MatcherCase& each : matcherCases()) {
    SCOPED_TRACE(each.matcher);
    const cv::Mat& samples = each.type == CV_8U ? bits : numbers;
    const auto index = makeDescriptorIndex(each.matcher, samples, 50);
    const std::string others = each.type == CV_8U ? "CV_8UC1, 32 wide" : "CV_32FC1, 64 wide";
    const auto adding = [&](int32_t image_id, const cv::Mat& matrix) {
      return refusal<std::invalid_argument>([&] { index->add(image_id, matrix); });
    };
    EXPECT_EQ(adding(-1, samples), "image_id is -1, it must be 0 or above");
    EXPECT_EQ(adding(1, cv::Mat(65537, samples.cols, samples.type(), cv::Scalar(0))),
              "number of descriptors of an image is 65537, allowed is [0, 65536]");
    index->add(2, samples);
    for (const cv::Mat& other : {cv::Mat(9, 48, samples.type()), cv::Mat(9, samples.cols, CV_16S)}) {
      const std::string message = "descriptors are " + cv::typeToString(other.type()) + ", " +
                                  std::to_string(other.cols) + " wide; those of the index are " + others;
      EXPECT_EQ(adding(3, other), message);
      EXPECT_EQ(refusal<std::invalid_argument>([&] { index->search(other, 1); }), message);
    }
    EXPECT_EQ(refusal<std::invalid_argument>([&] { index->search(samples, 0); }),
              "k is 0, allowed is [1, 65536]");
    EXPECT_EQ(index->size(), 50);
  }
}

}  // namespace
}  // namespace sextant
