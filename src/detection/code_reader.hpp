// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

#include "sextant/markers/aruco_dictionary.hpp"
#include "sextant/markers/code_book.hpp"

namespace sextant {

/// The decoded modules of a square.
struct Code {
  double dark_border = 0;  ///< fraction of the border's modules that are dark
  int id = -1;             ///< id of the marker; -1: none
  int rotation = 0;        ///< quarter turns between the given corners and the marker's, as counted by OpenCV
};

/// Decodes the modules of a quad as OpenCV's aruco module does, and by a CodeBook where that fails.
class CodeReader {
 public:
  CodeReader(const cv::aruco::Dictionary& dictionary, const cv::aruco::DetectorParameters& parameters);

  /// Decodes a quad.
  /// @param image 8-bit grey
  /// @param corners clockwise, pixels
  Code read(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners);
  /// Whether a quad whose code was read can be a marker: where random bits are often a code, only one with
  /// the light and the dark modules of its border.
  bool trusts(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners);
  /// Whether the quad shows this marker, the first corner top left.
  bool shows(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners, int id);

 private:
  bool flatten(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners);
  Code readBits();
  cv::Mat marker() const;
  float grey(int column, int row) const;
  Eigen::VectorXf greys() const;
  Eigen::VectorXf ring(int inset) const;
  double border() const;
  float clarity() const;
  bool isVeryClear() const;
  bool isBlurred() const;

  cv::aruco::Dictionary dictionary_;
  cv::aruco::DetectorParameters parameters_;
  bool weak_;  // random bits are often a code
  CodeBook book_;
  cv::Mat flat_, binary_, modules_;
};

}  // namespace sextant
