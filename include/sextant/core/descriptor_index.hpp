// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace sextant {

/// The nearest neighbours of each of n descriptors, nearest first.
struct Neighbours {
  int k = 0;                     ///< neighbours of a descriptor
  std::vector<float> distances;  ///< n x k; not squared
  std::vector<int32_t> owners;   ///< n x k; whose descriptor it is, as given to add(); -1: there are no more
  std::vector<int32_t> rows;     ///< n x k; which of its owner's descriptors
};

/// Descriptors of many pictures, and which of them are near to a given one. Searching is thread-safe.
class DescriptorIndex {
 public:
  virtual ~DescriptorIndex() = default;

  /// @param owner 0 or above, not added before
  /// @param descriptors at most 65536 rows
  /// @throws std::invalid_argument for anything else, or descriptors of another kind than the index has
  virtual void add(int32_t owner, const cv::Mat& descriptors) = 0;

  /// Takes an owner's descriptors out; nothing happens where there are none.
  virtual void remove(int32_t owner) = 0;

  /// @param k at least 1
  virtual Neighbours search(const cv::Mat& descriptors, int k) const = 0;

  virtual int64_t size() const = 0;   ///< descriptors
  virtual int64_t bytes() const = 0;  ///< of memory that grow with them

  /// Appends the index to a file, to be read by readDescriptorIndex(); only those by faiss can.
  /// @throws std::runtime_error that says why it cannot be
  virtual void append(const std::string& path) const = 0;
};

/// How descriptors are compared: faiss, or one of OpenCV's matchers: FlannBased, BruteForce, BruteForce-L1,
/// BruteForce-Hamming, BruteForce-Hamming(2).
std::vector<std::string> matcherNames();

/// @throws std::invalid_argument where a matcher is unknown, or does not compare what the extractor makes
void validateMatcher(const std::string& matcher, const std::string& extractor, int orb_wta_k);

/// An empty index.
/// @param samples of the descriptors that will be in it, of at least one picture: faiss learns how to store
/// them
/// @param expected how many descriptors there will be
/// @throws std::invalid_argument for an unknown matcher, or no sample
std::unique_ptr<DescriptorIndex> makeDescriptorIndex(const std::string& matcher, const cv::Mat& samples,
                                                     int64_t expected);

/// What append() wrote at an offset of a file. Its descriptors stay there, mapped into memory, until the
/// index is changed; the file must not be written to.
/// @throws std::runtime_error that says why it cannot be read
std::unique_ptr<DescriptorIndex> readDescriptorIndex(const std::string& path, int64_t offset);

}  // namespace sextant
