// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "sextant/base/params.hpp"

namespace sextant {

/// How a picture becomes keypoints and descriptors. The defaults are for a camera that does not roll.
struct FeatureParams {
  std::string detector = "SIFT";
  std::string extractor = "SIFT";
  int max_side = 320;
  int max_features = 250;
  bool upright = true;
  bool root = true;
  double support = 3.0;
  double sift_contrast = 0.005;
  double surf_threshold = 30.0;
  double akaze_threshold = 0.001;
  int orb_wta_k = 2;

  /// Every picture whole, keypoints and descriptors as their inventors have them.
  static FeatureParams plain(const std::string& detector, const std::string& extractor);

  ParamList fields();
};

/// The detectors and extractors there are: AKAZE, ORB, SIFT, SURF (dlib's).
std::vector<std::string> featureNames();

/// Whether descriptors of an extractor are bits (Hamming distance), not numbers (L2).
/// @throws std::invalid_argument where there is no such extractor
bool isBinaryExtractor(const std::string& extractor);

/// What is kept of a picture.
struct LocalFeatures {
  cv::Size size;                        ///< pixels of the picture
  std::vector<cv::KeyPoint> keypoints;  ///< in pixels of it
  cv::Mat descriptors;  ///< a row a keypoint; CV_32F, or CV_8U for bits; whole numbers up to 255 of SIFT
};

/// Finds and describes the keypoints of pictures; thread-safe.
class FeatureExtractor {
 public:
  /// @throws std::invalid_argument as validate(FeatureParams)
  explicit FeatureExtractor(const FeatureParams& params);

  /// @param image 8-bit grey, not empty
  /// @throws std::invalid_argument for any other image
  LocalFeatures extract(const cv::Mat& image) const;

 private:
  FeatureParams params_;
};

}  // namespace sextant
