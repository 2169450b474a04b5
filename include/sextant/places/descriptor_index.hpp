// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace sextant {

/// The k nearest neighbours of each of n query descriptors, nearest first; all arrays are n x k, row by row.
struct Neighbours {
  int k = 0;                       ///< neighbours per descriptor
  std::vector<float> distances;    ///< not squared; infinite if there are fewer than k neighbours
  std::vector<int32_t> image_ids;  ///< image of the neighbour, as passed to add(); -1 if there is none
  std::vector<int32_t> rows;  ///< row of the neighbour among its image's descriptors; -1 if there is none
};

/// Nearest-neighbour index of the descriptors of many images. Searching is thread-safe.
class DescriptorIndex {
 public:
  static constexpr int kMaxRows = 65536;  ///< maximum number of descriptors per image

  virtual ~DescriptorIndex() = default;

  /// Adds the descriptors of one image.
  /// @param image_id at least 0, not yet in the index
  /// @param descriptors one per row, at most kMaxRows; type and width of the samples
  /// @throws std::invalid_argument if image_id is negative or the descriptors do not fit
  void add(int32_t image_id, const cv::Mat& descriptors);

  /// Removes the descriptors of an image, if there are any.
  virtual void remove(int32_t image_id) = 0;

  /// Finds the k nearest neighbours of each descriptor.
  /// @param descriptors one per row; type and width of the samples
  /// @param k [1, kMaxRows]
  /// @throws std::invalid_argument if k or the descriptors do not fit
  Neighbours search(const cv::Mat& descriptors, int k) const;

  virtual int64_t size() const = 0;   ///< number of descriptors
  virtual int64_t bytes() const = 0;  ///< memory of the stored descriptors

  /// Appends the index to a file, for readDescriptorIndex(). Loads a mapped index into memory.
  /// @throws std::runtime_error with the reason
  virtual void append(const std::string& path) = 0;

 protected:
  /// No descriptors. @param type OpenCV's element type @param width elements of a descriptor
  DescriptorIndex(int type, int width) : type_(type), width_(width) {}

 private:
  // Descriptors are checked, continuous and not empty; image_ids are initialized with -1.
  virtual void addChecked(int32_t image_id, const cv::Mat& descriptors) = 0;
  virtual void searchChecked(const cv::Mat& descriptors, Neighbours& found) const = 0;

  cv::Mat checked(const cv::Mat& descriptors) const;

  int type_, width_;
};

/// Names of the matchers: faiss and those of OpenCV: FlannBased, BruteForce, BruteForce-L1,
/// BruteForce-Hamming, BruteForce-Hamming(2).
std::vector<std::string> matcherNames();

/// @throws std::invalid_argument if the matcher is unknown or cannot compare the extractor's descriptors
void validateMatcher(const std::string& matcher, const std::string& extractor, int orb_wta_k);

/// Creates an empty index.
/// @param samples training descriptors from which faiss learns its quantizers; CV_32F, or CV_8U for binary
/// ones
/// @param expected expected number of descriptors in the index
/// @throws std::invalid_argument for an unknown matcher, one that cannot compare the samples, no sample, or a
/// negative number
std::unique_ptr<DescriptorIndex> makeDescriptorIndex(const std::string& matcher, const cv::Mat& samples,
                                                     int64_t expected);

/// Whether the library was built with faiss. Without it, the matcher faiss searches exactly, by OpenCV's
/// brute force.
bool hasFaiss();

/// Reads an index that append() wrote at an offset in bytes. The descriptors of a faiss index stay
/// memory-mapped until it is changed; the file must not be modified before.
/// @throws std::runtime_error with the reason
std::unique_ptr<DescriptorIndex> readDescriptorIndex(const std::string& path, int64_t offset);

}  // namespace sextant
