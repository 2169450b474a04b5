// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

namespace sextant {

/// How a picture becomes keypoints and descriptors. The defaults are for a camera that does not roll.
struct FeatureParams {
  std::string detector = "SIFT";   ///< any of featureNames()
  std::string extractor = "SIFT";  ///< any of featureNames(); AKAZE describes AKAZE's keypoints only
  int max_side = 320;              ///< [0, 16384] pixels; larger pictures are reduced to it; 0: none is
  int max_features = 250;          ///< [0, 1000000]; the strongest of a picture; 0: all (ORB: its 500)
  bool upright = true;             ///< descriptors are not turned with the picture
  bool root = true;                ///< SIFT: RootSIFT
  double support = 3.0;            ///< (0, 16]; SIFT and SURF describe a neighbourhood larger by this factor
  double sift_contrast = 0.005;    ///< (0, 1]; less is no keypoint; OpenCV's own default is 0.04
  double surf_threshold = 30.0;    ///< (0, 1e6]; dlib's measure, not OpenCV's
  double akaze_threshold = 0.001;  ///< (0, 1]
  int orb_wta_k = 2;  ///< [2, 4]; points that decide a bit; 3 and 4 are for BruteForce-Hamming(2)

  /// Every picture whole, keypoints and descriptors as their inventors have them.
  static FeatureParams plain(const std::string& detector, const std::string& extractor);

  /// @throws std::invalid_argument that names the first field out of range, or a pair that cannot be
  void validate() const;
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
  /// @throws std::invalid_argument as FeatureParams::validate()
  explicit FeatureExtractor(const FeatureParams& params);

  /// @param image 8-bit grey, not empty
  /// @throws std::invalid_argument for any other image
  LocalFeatures extract(const cv::Mat& image) const;

 private:
  FeatureParams params_;
};

}  // namespace sextant
