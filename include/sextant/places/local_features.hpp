// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "sextant/base/params.hpp"

namespace sextant {

/// Parameters of keypoint detection and description; see fields(). The defaults are for a camera without
/// roll.
struct FeatureParams {
  std::string detector = "SIFT";
  std::string extractor = "SIFT";
  int max_side = 320;
  double min_size = 0;
  int max_features = 300;
  bool upright = true;
  bool root_sift = true;
  double support_scale = 3.0;
  double sift_contrast = 0.005;
  double surf_threshold = 30.0;
  double akaze_threshold = 0.001;
  int orb_wta_k = 2;

  /// Full-size images, detector and extractor with OpenCV's defaults.
  static FeatureParams plain(const std::string& detector, const std::string& extractor);

  /// The parameters with ranges, units and descriptions.
  ParamList fields();
};

/// Names of the detectors and extractors: AKAZE, ORB, SIFT, SURF (dlib's).
std::vector<std::string> featureNames();

/// Whether an extractor's descriptors are binary (Hamming distance) rather than real-valued (L2 distance).
/// @throws std::invalid_argument if the extractor is unknown
bool isBinaryExtractor(const std::string& extractor);

/// Keypoints and descriptors of one image.
struct LocalFeatures {
  cv::Size size;                        ///< of the image, pixels
  std::vector<cv::KeyPoint> keypoints;  ///< in image pixels
  cv::Mat descriptors;  ///< one row per keypoint; CV_32F, or CV_8U if binary; SIFT: integers in [0, 255]
};

/// Detects and describes the keypoints of images; thread-safe.
class FeatureExtractor {
 public:
  /// @throws std::invalid_argument for invalid parameters
  explicit FeatureExtractor(const FeatureParams& params);

  /// Detects and describes keypoints.
  /// @param image 8-bit grey, not empty
  /// @throws std::invalid_argument for any other image
  LocalFeatures extract(const cv::Mat& image) const;

 private:
  FeatureParams params_;
};

}  // namespace sextant
