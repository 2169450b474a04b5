// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "marker_search.hpp"
#include "marker_tracks.hpp"
#include "quad_search.hpp"
#include "sextant/core/marker.hpp"

namespace sextant {

/// Lets one backend look where markers are worth looking for: everywhere in the first image and in those of
/// another size; then where markers should be, in the strips in which new ones come in, and in one image of
/// three wherever a quad is. A new marker is found within three images.
class MarkerTracker {
 public:
  /// @param tracking else every image is searched everywhere
  MarkerTracker(std::unique_ptr<MarkerSearch> search, bool tracking)
      : search_(std::move(search)), tracking_(tracking) {}

  /// The next image's markers, with the backend's own corners.
  std::vector<Detection> find(const cv::Mat& image);

  const MarkerSearch& search() const { return *search_; }

 private:
  void follow(const cv::Mat& image, FoundMarkers& found);
  bool lookFor(const MarkerTracks::Expected& marker, double margin, Effort effort, const cv::Mat& image,
               FoundMarkers& found);
  void sweep(const cv::Mat& image, const cv::Rect& part, FoundMarkers& found);

  std::unique_ptr<MarkerSearch> search_;
  bool tracking_;
  cv::Size size_;
  MarkerTracks tracks_;
  QuadSearch quads_;
  int since_sweep_ = 0;  // images
};

}  // namespace sextant
