// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/camera.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// Parameters of makeMarkerDetector().
struct DetectorParams {
  std::vector<std::string> families = {"tag36h11"};
  std::string search = "full";
  int threads = 1;
  double decimate = 1.0;
  int max_hamming = 2;
  double min_decision_margin = 0.0;
  double error_correction = 0.6;
  double min_perimeter = 0.02;
  bool refine_corners = true;

  ParamList fields();
};

/// Detects markers in grey images. Not thread-safe: use one detector per thread.
class MarkerDetector {
 public:
  virtual ~MarkerDetector() = default;

  /// Detects all markers of an image.
  /// @param image 8-bit, one channel, at least 1 x 1; not modified
  /// @param camera camera of the image: refined corners then take lens distortion into account
  /// @throws std::invalid_argument for any other image
  virtual std::vector<Detection> detect(const cv::Mat& image, const CameraModel* camera = nullptr) = 0;
};

/// Creates a detector with the backends that the families need.
/// @throws std::invalid_argument as validate(DetectorParams).
std::unique_ptr<MarkerDetector> makeMarkerDetector(const DetectorParams& params);

}  // namespace sextant
