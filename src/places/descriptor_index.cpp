// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/descriptor_index.hpp"

#include <limits>
#include <map>
#include <stdexcept>

#include "matcher_index.hpp"
#include "sextant/base/range.hpp"
#include "sextant/places/local_features.hpp"
#ifdef SEXTANT_FAISS
#include "faiss_index.hpp"
#endif

namespace sextant {
namespace {

/// Descriptor types that a matcher compares; ORB with orb_wta_k 3 or 4 makes pairs of bits.
struct Supported {
  bool numbers, bits, pairs;
};

const std::map<std::string, Supported>& matchers() {
  static const std::map<std::string, Supported> all = {
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

bool fits(const Supported& supported, const std::string& extractor, int orb_wta_k) {
  if (makesPairs(extractor, orb_wta_k)) return supported.pairs;
  return isBinaryExtractor(extractor) ? supported.bits : supported.numbers;
}

bool fits(const Supported& supported, const cv::Mat& samples) {
  if (samples.type() == CV_8U) return supported.bits || supported.pairs;
  return samples.type() == CV_32F && supported.numbers;
}

std::string kind(int type, int width) {
  return cv::typeToString(type) + ", " + std::to_string(width) + " wide";
}

}  // namespace

void DescriptorIndex::add(int32_t image_id, const cv::Mat& descriptors) {
  if (image_id < 0)
    throw std::invalid_argument("image_id is " + std::to_string(image_id) + ", it must be 0 or above");
  Range::closed(0, kMaxRows).require("number of descriptors of an image", descriptors.rows);
  if (!descriptors.empty()) addChecked(image_id, checked(descriptors));
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
  for (const auto& [name, supported] : matchers()) names.push_back(name);
  return names;
}

void validateMatcher(const std::string& matcher, const std::string& extractor, int orb_wta_k) {
  const auto found = matchers().find(matcher);
  if (found != matchers().end() && fits(found->second, extractor, orb_wta_k)) return;
  std::string names;
  for (const auto& [name, supported] : matchers())
    if (fits(supported, extractor, orb_wta_k)) names += (names.empty() ? "" : ", ") + name;
  const std::string pairs = makesPairs(extractor, orb_wta_k) ? " with orb_wta_k 3 or 4" : "";
  throw std::invalid_argument("matcher is '" + matcher + "', for extractor " + extractor + pairs +
                              " it must be one of " + names);
}

std::unique_ptr<DescriptorIndex> makeDescriptorIndex(const std::string& matcher, const cv::Mat& samples,
                                                     int64_t expected) {
  const auto found = matchers().find(matcher);
  if (found == matchers().end()) throw std::invalid_argument("unknown matcher '" + matcher + "'");
  if (samples.empty()) throw std::invalid_argument("a descriptor index needs sample descriptors");
  if (!fits(found->second, samples))
    throw std::invalid_argument("matcher '" + matcher + "' cannot compare descriptors of type " +
                                kind(samples.type(), samples.cols));
  if (expected < 0) throw std::invalid_argument("the expected number of descriptors is negative");
  if (matcher != "faiss") return makeMatcherIndex(matcher, samples.type(), samples.cols);
#ifdef SEXTANT_FAISS
  return makeFaissIndex(samples.isContinuous() ? samples : samples.clone(), expected);
#else
  return makeMatcherIndex(samples.type() == CV_8U ? "BruteForce-Hamming" : "BruteForce", samples.type(),
                          samples.cols);
#endif
}

bool hasFaiss() {
#ifdef SEXTANT_FAISS
  return true;
#else
  return false;
#endif
}

std::unique_ptr<DescriptorIndex> readDescriptorIndex(const std::string& path, int64_t offset) {
  if (auto index = readMatcherIndex(path, offset)) return index;
#ifdef SEXTANT_FAISS
  return readFaissIndex(path, offset);
#else
  throw std::runtime_error(path + ": the index cannot be read: it is not of this version");
#endif
}

}  // namespace sextant
