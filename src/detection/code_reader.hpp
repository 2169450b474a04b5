// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

#include "sextant/markers/aruco_dictionary.hpp"

namespace sextant {

/// The decoded modules of a square.
struct Code {
  double dark_border = 0;  ///< fraction of the border's modules that are dark
  int id = -1;             ///< id of the marker; -1: none
  int rotation = 0;        ///< quarter turns between the given corners and the marker's, as counted by OpenCV
};

/// Decodes the modules of a quad as OpenCV's aruco module does.
class CodeReader {
 public:
  CodeReader(const cv::aruco::Dictionary& dictionary, const cv::aruco::DetectorParameters& parameters);

  /// Decodes a quad.
  /// @param image 8-bit grey
  /// @param corners clockwise, pixels
  Code read(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners);

 private:
  cv::aruco::Dictionary dictionary_;
  cv::aruco::DetectorParameters parameters_;
  cv::Mat flat_, modules_;
};

}  // namespace sextant
