// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "sextant/markers/apriltag_family.hpp"
#include "sextant/markers/code_book.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// How the code of a tag appears between its corners.
struct TagReading {
  int hamming;    ///< number of bits that differ from the code
  double margin;  ///< mean distance of the white or the black bits, whichever is smaller, from the threshold
  double contrast;  ///< from the border's black to its white; this and the margin in grey levels
  double border;   ///< fraction of the border's modules, its white ones as well, that are on their side of it
  double clarity;  ///< margin without sharpening over that of an ideal print in this light, about 0 to 1
};

/// Reads the code of an AprilTag whose corners are known. As in libapriltag, the threshold is the mean of two
/// planes that are fitted to the brightness of the white and of the black modules of the border, and the bits
/// are sharpened before they are compared with it.
class AprilTagReader {
 public:
  /// @param family must outlive this object
  explicit AprilTagReader(const apriltag_family_t& family);

  /// Compares the image with the code of an id.
  /// @param image 8-bit grey
  /// @return nothing if the border's white is not five grey levels lighter than its black, or both are
  /// outside of the image
  std::optional<TagReading> read(const cv::Mat& image, int id, const Corners& corners) const;
  /// Finds the id by the CodeBook of the family, for tags that are blurred.
  /// @param corners clockwise, from any one
  /// @return nothing if there is no match, or if the family has too many codes for a book
  std::optional<CodeMatch> identify(const cv::Mat& image, const Corners& corners) const;
  /// TagReading::border of a quad that may be a tag; 0 if there is no reading.
  double border(const cv::Mat& image, const Corners& corners) const;
  /// Whether the code resembles that of the id, in a family with a book.
  bool resembles(const cv::Mat& image, int id, const Corners& corners) const;

 private:
  struct Bits;
  bool bit(int id, size_t index) const { return family_.codes[id] >> (family_.nbits - 1 - index) & 1; }
  std::optional<Bits> bits(const cv::Mat& image, const Corners& corners) const;
  void makeBook();
  double sharpened(const std::vector<double>& grid, size_t cell) const;

  const apriltag_family_t& family_;
  int stride_;                 // of the grid of all modules and a row and a column around them
  std::vector<size_t> cells_;  // of the bits in this grid
  std::unique_ptr<CodeBook> book_;
};

}  // namespace sextant
