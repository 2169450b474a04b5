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
  std::vector<float> distances;  ///< n x k; not squared; infinite where there are no more
  std::vector<int32_t> owners;   ///< n x k; whose descriptor it is, as given to add(); -1: there are no more
  std::vector<int32_t> rows;     ///< n x k; which of its owner's descriptors; -1 as above
};

/// Descriptors of many pictures, and which of them are near to a given one. Searching is thread-safe.
class DescriptorIndex {
 public:
  static constexpr int kMaxRows = 65536;  ///< descriptors of an owner

  virtual ~DescriptorIndex() = default;

  /// @param owner 0 or above; one that has no descriptors in the index
  /// @param descriptors at most kMaxRows, of the samples' type and width
  /// @throws std::invalid_argument where the owner is below 0 or the descriptors are not such
  void add(int32_t owner, const cv::Mat& descriptors);

  /// Takes an owner's descriptors out; nothing happens where there are none.
  virtual void remove(int32_t owner) = 0;

  /// @param descriptors any number, of the samples' type and width
  /// @param k [1, kMaxRows]
  /// @throws std::invalid_argument where they are not
  Neighbours search(const cv::Mat& descriptors, int k) const;

  virtual int64_t size() const = 0;   ///< descriptors
  virtual int64_t bytes() const = 0;  ///< of memory that grow with them

  /// Appends the index to a file, to be read by readDescriptorIndex(); only those by faiss can. One that was
  /// read has all in memory afterwards.
  /// @throws std::runtime_error that says why it cannot be
  virtual void append(const std::string& path) = 0;

 protected:
  DescriptorIndex(int type, int width) : type_(type), width_(width) {}

 private:
  // Both get what is checked, not empty and continuous; owners are -1 until something is found.
  virtual void addChecked(int32_t owner, const cv::Mat& descriptors) = 0;
  virtual void searchChecked(const cv::Mat& descriptors, Neighbours& found) const = 0;

  cv::Mat checked(const cv::Mat& descriptors) const;

  int type_, width_;
};

/// How descriptors are compared: faiss, or one of OpenCV's matchers: FlannBased, BruteForce, BruteForce-L1,
/// BruteForce-Hamming, BruteForce-Hamming(2).
std::vector<std::string> matcherNames();

/// @throws std::invalid_argument where a matcher is unknown, or does not compare what the extractor makes
void validateMatcher(const std::string& matcher, const std::string& extractor, int orb_wta_k);

/// An empty index.
/// @param samples of the descriptors that will be in it, of at least one picture; CV_32F, or CV_8U for bits.
/// faiss learns from them how to store descriptors.
/// @param expected how many descriptors there will be
/// @throws std::invalid_argument for an unknown matcher, one that does not compare such samples, no sample,
/// or a negative number
std::unique_ptr<DescriptorIndex> makeDescriptorIndex(const std::string& matcher, const cv::Mat& samples,
                                                     int64_t expected);

/// What append() wrote at an offset of a file. Its descriptors stay there, mapped into memory, until the
/// index is changed; the file must not be written to before.
/// @throws std::runtime_error that says why it cannot be read
std::unique_ptr<DescriptorIndex> readDescriptorIndex(const std::string& path, int64_t offset);

}  // namespace sextant
