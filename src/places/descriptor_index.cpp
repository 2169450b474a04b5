// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/descriptor_index.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <opencv2/features2d.hpp>
#include <stdexcept>

#include "faiss_index.hpp"
#include "sextant/base/range.hpp"
#include "sextant/places/local_features.hpp"

namespace sextant {
namespace {

constexpr int kMaxPiece = 1 << 17;  // rows of a matrix; OpenCV's brute force takes fewer than 1 << 18

/// What a matcher compares; pairs of bits are what ORB makes with orb_wta_k 3 or 4.
struct Compares {
  bool numbers, bits, pairs;
};

const std::map<std::string, Compares>& matchers() {
  static const std::map<std::string, Compares> all = {
      {"faiss", {true, true, false}},
      {"FlannBased", {true, false, false}},
      {"BruteForce", {true, false, false}},
      {"BruteForce-L1", {true, false, false}},
      {"BruteForce-Hamming", {false, true, false}},
      {"BruteForce-Hamming(2)", {false, false, true}},
  };
  return all;
}

bool makesPairs(const std::string& extractor, int orb_wta_k) { return extractor == "ORB" && orb_wta_k > 2; }

bool fits(const Compares& compares, const std::string& extractor, int orb_wta_k) {
  if (makesPairs(extractor, orb_wta_k)) return compares.pairs;
  return isBinaryExtractor(extractor) ? compares.bits : compares.numbers;
}

bool fits(const Compares& compares, const cv::Mat& samples) {
  if (samples.type() == CV_8U) return compares.bits || compares.pairs;
  return samples.type() == CV_32F && compares.numbers;
}

/// While it lives, OpenCV draws the same numbers in this thread every time.
class RepeatedRandomness {
 public:
  RepeatedRandomness() : before_(cv::theRNG()) { cv::theRNG() = cv::RNG(kSeed); }
  ~RepeatedRandomness() { cv::theRNG() = before_; }
  RepeatedRandomness(const RepeatedRandomness&) = delete;
  RepeatedRandomness& operator=(const RepeatedRandomness&) = delete;

 private:
  static constexpr uint64_t kSeed = 1;
  cv::RNG before_;
};

/// One of OpenCV's, over the descriptors as they are.
class MatcherIndex : public DescriptorIndex {
 public:
  MatcherIndex(const std::string& matcher, const cv::Mat& samples)
      : DescriptorIndex(samples.type(), samples.cols), matcher_(cv::DescriptorMatcher::create(matcher)) {}

  void remove(int32_t owner) override {
    const auto is_owners = [owner](const Row& row) { return row.owner == owner; };
    const auto begin = std::find_if(rows_.begin(), rows_.end(), is_owners);
    const auto end = std::find_if_not(begin, rows_.end(), is_owners);
    if (begin == end) return;
    cv::Mat kept = descriptors_.rowRange(0, static_cast<int>(begin - rows_.begin())).clone();
    kept.push_back(descriptors_.rowRange(static_cast<int>(end - rows_.begin()), descriptors_.rows));
    rows_.erase(begin, end);
    descriptors_ = kept;
    trained_ = false;
  }

  int64_t size() const override { return static_cast<int64_t>(rows_.size()); }

  int64_t bytes() const override {
    return static_cast<int64_t>(descriptors_.total() * descriptors_.elemSize() + rows_.size() * sizeof(Row));
  }

  void append(const std::string& path) override {
    throw std::runtime_error(path + ": OpenCV's matchers cannot be stored");
  }

 private:
  struct Row {
    int32_t owner, row;
  };

  void addChecked(int32_t owner, const cv::Mat& descriptors) override {
    descriptors_.push_back(descriptors);
    for (int row = 0; row < descriptors.rows; ++row) rows_.push_back({owner, row});
    trained_ = false;
  }

  void searchChecked(const cv::Mat& descriptors, Neighbours& found) const override {
    const std::lock_guard<std::mutex> lock(mutex_);  // OpenCV's train themselves when they are asked
    if (rows_.empty()) return;
    train();
    std::vector<std::vector<cv::DMatch>> matches;
    matcher_->knnMatch(descriptors, matches, std::min(found.k, descriptors_.rows));
    for (const auto& neighbours : matches)
      for (size_t i = 0; i < neighbours.size(); ++i) {
        const size_t at = static_cast<size_t>(neighbours[i].queryIdx) * found.k + i;
        const Row& row = rows_[pieceBegin(neighbours[i].imgIdx) + neighbours[i].trainIdx];
        found.distances[at] = neighbours[i].distance;
        found.owners[at] = row.owner;
        found.rows[at] = row.row;
      }
  }

  void train() const {
    if (trained_) return;
    matcher_->clear();
    for (int piece = 0; piece < pieces(); ++piece)
      matcher_->add(std::vector<cv::Mat>{descriptors_.rowRange(pieceBegin(piece), pieceBegin(piece + 1))});
    const RepeatedRandomness same;  // FLANN's trees
    matcher_->train();
    trained_ = true;
  }

  // OpenCV's brute force gives nonsense where one of several matrices has fewer than k rows: no matrix a
  // picture, but pieces of about the same size.
  int pieces() const { return 1 + (descriptors_.rows - 1) / kMaxPiece; }
  int pieceBegin(int piece) const {
    return static_cast<int>(static_cast<int64_t>(descriptors_.rows) * piece / pieces());
  }

  cv::Ptr<cv::DescriptorMatcher> matcher_;
  cv::Mat descriptors_;
  std::vector<Row> rows_;  // of descriptors_; an owner's follow each other
  mutable bool trained_ = false;
  mutable std::mutex mutex_;
};

std::string kind(int type, int width) {
  return cv::typeToString(type) + ", " + std::to_string(width) + " wide";
}

}  // namespace

void DescriptorIndex::add(int32_t owner, const cv::Mat& descriptors) {
  if (owner < 0) throw std::invalid_argument("owner is " + std::to_string(owner) + ", it must be 0 or above");
  Range::closed(0, kMaxRows).require("number of an owner's descriptors", descriptors.rows);
  if (!descriptors.empty()) addChecked(owner, checked(descriptors));
}

Neighbours DescriptorIndex::search(const cv::Mat& descriptors, int k) const {
  Range::closed(1, kMaxRows).require("k", k);
  const size_t count = static_cast<size_t>(descriptors.rows) * k;
  Neighbours found{k, std::vector<float>(count, std::numeric_limits<float>::infinity()),
                   std::vector<int32_t>(count, -1), std::vector<int32_t>(count, -1)};
  if (!descriptors.empty()) searchChecked(checked(descriptors), found);
  return found;
}

cv::Mat DescriptorIndex::checked(const cv::Mat& descriptors) const {
  if (descriptors.type() != type_ || descriptors.cols != width_)
    throw std::invalid_argument("descriptors are " + kind(descriptors.type(), descriptors.cols) +
                                "; those of the index are " + kind(type_, width_));
  return descriptors.isContinuous() ? descriptors : descriptors.clone();
}

std::vector<std::string> matcherNames() {
  std::vector<std::string> names;
  for (const auto& [name, compares] : matchers()) names.push_back(name);
  return names;
}

void validateMatcher(const std::string& matcher, const std::string& extractor, int orb_wta_k) {
  const auto found = matchers().find(matcher);
  if (found != matchers().end() && fits(found->second, extractor, orb_wta_k)) return;
  std::string names;
  for (const auto& [name, compares] : matchers())
    if (fits(compares, extractor, orb_wta_k)) names += (names.empty() ? "" : ", ") + name;
  const std::string pairs = makesPairs(extractor, orb_wta_k) ? " with orb_wta_k 3 or 4" : "";
  throw std::invalid_argument("matcher is '" + matcher + "'; for what extractor " + extractor + pairs +
                              " makes it must be one of " + names);
}

std::unique_ptr<DescriptorIndex> makeDescriptorIndex(const std::string& matcher, const cv::Mat& samples,
                                                     int64_t expected) {
  const auto found = matchers().find(matcher);
  if (found == matchers().end()) throw std::invalid_argument("matcher '" + matcher + "' is none");
  if (samples.empty()) throw std::invalid_argument("an index of descriptors needs samples of them");
  if (!fits(found->second, samples))
    throw std::invalid_argument("matcher '" + matcher + "' does not compare descriptors that are " +
                                kind(samples.type(), samples.cols));
  if (expected < 0) throw std::invalid_argument("the expected number of descriptors is below 0");
  if (matcher != "faiss") return std::make_unique<MatcherIndex>(matcher, samples);
  return makeFaissIndex(samples.isContinuous() ? samples : samples.clone(), expected);
}

std::unique_ptr<DescriptorIndex> readDescriptorIndex(const std::string& path, int64_t offset) {
  return readFaissIndex(path, offset);
}

}  // namespace sextant
