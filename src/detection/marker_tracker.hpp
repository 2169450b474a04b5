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

/// Lets one backend look where markers are worth looking for: everywhere in the first image and in those of
/// another size; then where markers should be, in the strips in which new ones come in, and in one image of
/// three wherever a quad is. A new marker is found within three images. Of one that moves steadily the edges
/// are found from where they should be, and its code is read between them.
class MarkerTracker {
 public:
  /// @param tracking else every image is searched everywhere
  /// @param refine else corners are the backend's own
  MarkerTracker(std::unique_ptr<MarkerSearch> search, bool tracking, bool refine)
      : search_(std::move(search)), tracking_(tracking), refine_(refine) {}

  /// The next image's markers.
  /// @param camera may be null: then the lens is not known
  std::vector<Detection> find(const cv::Mat& image, const CameraModel* camera);

 private:
  void follow(const cv::Mat& image, const CameraModel* camera, FoundMarkers& found);
  void refine(const cv::Mat& image, const CameraModel* camera, Detection& marker) const;
  void confirm(const MarkerTracks::Expected& expected, const cv::Mat& image, const CameraModel* camera,
               FoundMarkers& found) const;
  void lookFor(const MarkerTracks::Expected& marker, const cv::Mat& image, FoundMarkers& found);
  void sweep(const cv::Mat& image, const cv::Rect& part, FoundMarkers& found);

  std::unique_ptr<MarkerSearch> search_;
  bool tracking_, refine_;
  cv::Size size_;
  MarkerTracks tracks_;
  QuadSearch quads_;
  int since_sweep_ = 0;            // images
  std::vector<cv::Rect> cut_off_;  // by the border of that one
};

}  // namespace sextant
