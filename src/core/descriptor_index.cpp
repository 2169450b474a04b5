// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/descriptor_index.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <opencv2/features2d.hpp>
#include <stdexcept>

#include "faiss_index.hpp"
#include "sextant/core/local_features.hpp"

namespace sextant {
namespace {

enum class Compares { ANY, NUMBERS, BITS, PAIRS_OF_BITS };

const std::map<std::string, Compares>& matchers() {
  static const std::map<std::string, Compares> all = {
      {"faiss", Compares::ANY},
      {"FlannBased", Compares::NUMBERS},
      {"BruteForce", Compares::NUMBERS},
      {"BruteForce-L1", Compares::NUMBERS},
      {"BruteForce-Hamming", Compares::BITS},
      {"BruteForce-Hamming(2)", Compares::PAIRS_OF_BITS},
  };
  return all;
}

bool fits(Compares compares, const std::string& extractor, int orb_wta_k) {
  const bool bits = isBinaryExtractor(extractor), pairs = extractor == "ORB" && orb_wta_k > 2;
  const std::map<Compares, bool> all = {
      {Compares::ANY, !pairs},
      {Compares::NUMBERS, !bits},
      {Compares::BITS, bits && !pairs},
      {Compares::PAIRS_OF_BITS, pairs},
  };
  return all.at(compares);
}

/// One of OpenCV's, over the descriptors as they are.
class MatcherIndex : public DescriptorIndex {
 public:
  explicit MatcherIndex(const std::string& matcher) : matcher_(cv::DescriptorMatcher::create(matcher)) {}

  void add(int32_t owner, const cv::Mat& descriptors) override {
    if (descriptors.empty()) return;
    descriptors_[owner] = descriptors.clone();
    stale_ = true;
  }

  void remove(int32_t owner) override { stale_ |= descriptors_.erase(owner) > 0; }

  Neighbours search(const cv::Mat& descriptors, int k) const override {
    const std::lock_guard<std::mutex> lock(mutex_);  // OpenCV's train themselves when they are asked
    refresh();
    std::vector<std::vector<cv::DMatch>> matches;
    if (!owners_.empty() && !descriptors.empty()) matcher_->knnMatch(descriptors, matches, k);
    const size_t count = static_cast<size_t>(descriptors.rows) * k;
    Neighbours found{k, std::vector<float>(count), std::vector<int32_t>(count, -1),
                     std::vector<int32_t>(count, -1)};
    for (const auto& neighbours : matches)
      for (size_t i = 0; i < neighbours.size(); ++i) {
        const size_t at = static_cast<size_t>(neighbours[i].queryIdx) * k + i;
        found.distances[at] = neighbours[i].distance;
        found.owners[at] = owners_[neighbours[i].imgIdx];
        found.rows[at] = neighbours[i].trainIdx;
      }
    return found;
  }

  int64_t size() const override {
    int64_t rows = 0;
    for (const auto& [owner, descriptors] : descriptors_) rows += descriptors.rows;
    return rows;
  }

  int64_t bytes() const override {
    int64_t sum = 0;
    for (const auto& [owner, descriptors] : descriptors_)
      sum += static_cast<int64_t>(descriptors.total() * descriptors.elemSize());
    return sum;
  }

  void append(const std::string& path) const override {
    throw std::runtime_error(path + ": OpenCV's matchers cannot be stored");
  }

 private:
  void refresh() const {
    if (!stale_) return;
    matcher_->clear();
    owners_.clear();
    std::vector<cv::Mat> all;
    for (const auto& [owner, descriptors] : descriptors_) {
      owners_.push_back(owner);
      all.push_back(descriptors);
    }
    matcher_->add(all);
    matcher_->train();
    stale_ = false;
  }

  cv::Ptr<cv::DescriptorMatcher> matcher_;
  std::map<int32_t, cv::Mat> descriptors_;
  mutable std::vector<int32_t> owners_;
  mutable bool stale_ = false;
  mutable std::mutex mutex_;
};

}  // namespace

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
  const std::string pairs = extractor == "ORB" && orb_wta_k > 2 ? " with orb_wta_k 3 or 4" : "";
  throw std::invalid_argument("matcher is '" + matcher + "'; for what extractor " + extractor + pairs +
                              " makes it must be one of " + names);
}

std::unique_ptr<DescriptorIndex> makeDescriptorIndex(const std::string& matcher, const cv::Mat& samples,
                                                     int64_t expected) {
  if (!matchers().count(matcher)) throw std::invalid_argument("matcher '" + matcher + "' is none");
  if (matcher != "faiss") return std::make_unique<MatcherIndex>(matcher);
  if (samples.empty()) throw std::invalid_argument("DescriptorIndex: faiss needs samples to learn from");
  return makeFaissIndex(samples, expected);
}

std::unique_ptr<DescriptorIndex> readDescriptorIndex(const std::string& path, int64_t offset) {
  return readFaissIndex(path, offset);
}

}  // namespace sextant
