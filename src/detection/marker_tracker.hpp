// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "marker_search.hpp"
#include "marker_tracks.hpp"
#include "quad_search.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// Selects the parts of each image in which a backend searches: the whole image first and after a change of
/// size; then the predicted positions of markers, the strips at the sides where new parts of it come into
/// view, and in every third image all quads. A new marker is detected within three images, a faint one
/// within 30. A marker in steady motion is not searched: its edges are fitted from the predicted ones, and
/// its code is read between them.
class MarkerTracker {
 public:
  /// @param tracking false: search every image completely
  /// @param refine false: return the backend's own corners
  MarkerTracker(std::unique_ptr<MarkerSearch> search, bool tracking, bool refine)
      : search_(std::move(search)), tracking_(tracking), refine_(refine) {}

  /// Detects the markers of the next image.
  /// @param camera nullptr: unknown lens
  std::vector<Detection> find(const cv::Mat& image, const CameraModel* camera);

 private:
  void follow(const cv::Mat& image, const CameraModel* camera, FoundMarkers& found);
  void refine(const cv::Mat& image, const CameraModel* camera, Detection& marker) const;
  void confirm(const MarkerTracks::Expected& expected, const cv::Mat& image, const CameraModel* camera,
               FoundMarkers& found) const;
  /// Searches the missing markers where they are expected. Returns false where that costs too much.
  bool lookFor(const std::vector<MarkerTracks::Expected>& expected, const cv::Mat& image,
               FoundMarkers& found);
  bool leaves(const cv::Mat& image, const Detection& marker) const;
  void sweep(const cv::Mat& image, const cv::Rect& part, FoundMarkers& found);

  std::unique_ptr<MarkerSearch> search_;
  bool tracking_, refine_;
  cv::Size size_;
  MarkerTracks tracks_;
  QuadSearch quads_;
  int since_sweep_ = 0;            // images
  int sweeps_ = 0;                 // of whole images
  std::vector<cv::Rect> cut_off_;  // boxes of outlines at the border of that image
};

}  // namespace sextant
