// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "sextant/geometry/camera.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

struct DetectorParams {
  std::vector<std::string> families = {
      "tag36h11"};  ///< any of markerFamilies(); several are searched one after another
  /// full: every image by itself. tracking: images of one camera in order; markers are looked for where they
  /// should be, and new ones in one image of three.
  std::string search = "full";
  int threads = 1;        ///< [1, 64]; threads of the AprilTag backend (OpenCV's are the process's own)
  double decimate = 1.0;  ///< [1, 8]; AprilTag: quads are searched in an image smaller by this factor
  int max_hamming = 2;    ///< [0, 3]; AprilTag: more corrected bits than this is no detection
  double min_decision_margin = 20.0;  ///< [0, 255]; AprilTag: less contrast than this is no detection
  double error_correction =
      0.6;  ///< [0, 1]; ArUco: share of the dictionary's correctable bits that are corrected
  double min_perimeter = 0.02;  ///< (0, 4]; ArUco: smallest marker, its perimeter over the larger image side
  bool refine_corners = true;   ///< corners from lines fitted to the edges in the full image

  /// @throws std::invalid_argument that names the first field out of range.
  void validate() const;
};

/// Finds markers in a grey image. Not thread-safe: one detector a thread.
class MarkerDetector {
 public:
  virtual ~MarkerDetector() = default;

  /// @param image 8-bit, one channel, at least 1 x 1; not modified.
  /// @param camera that took it: refined corners then are those of straight edges seen through its lens
  /// @throws std::invalid_argument for any other image.
  virtual std::vector<Detection> detect(const cv::Mat& image, const CameraModel* camera = nullptr) = 0;
};

/// The backends that the families need, behind one interface.
/// @throws std::invalid_argument as DetectorParams::validate().
std::unique_ptr<MarkerDetector> makeMarkerDetector(const DetectorParams& params);

}  // namespace sextant
