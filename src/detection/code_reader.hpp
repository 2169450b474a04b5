// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/aruco.hpp>
#include <opencv2/core/mat.hpp>

namespace sextant {

/// What a square's modules are.
struct Code {
  double dark_border = 0;  ///< share of its border's modules that are dark
  int id = -1;             ///< of the marker; -1: none
  int rotation = 0;        ///< quarter turns that OpenCV counts between the corners read and the marker's own
};

/// Reads the modules of a quad as OpenCV's aruco module does, which also knows the code.
class CodeReader {
 public:
  CodeReader(cv::Ptr<cv::aruco::Dictionary> dictionary, cv::Ptr<cv::aruco::DetectorParameters> parameters);

  /// @param image 8-bit grey
  /// @param corners clockwise, pixels
  Code read(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners);

 private:
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
  cv::Mat flat_, modules_;
};

}  // namespace sextant
