// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "marker_search.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// Predicts the markers of the next image with constant velocity in the image; a marker detected only once
/// gets the mean velocity of the others.
class MarkerTracks {
 public:
  /// A predicted marker.
  struct Expected {
    MarkerKey key;
    Corners corners;  ///< pixels
    double margin;    ///< width of the search region around the corners, pixels
    bool steady;      ///< detected in the last image and before
  };

  /// Predicts the markers whose centre is in the next image.
  std::vector<Expected> expect(const cv::Size& image) const;
  /// The strips at the sides of the image where new parts of the scene come into view, deep enough for
  /// the largest marker so far. Empty without motion.
  /// @param cut_off boxes of outlines at the image border up to three images ago: candidates for new markers
  std::vector<cv::Rect> entrances(const cv::Size& image, const std::vector<cv::Rect>& cut_off) const;
  /// Updates the tracks with the markers of an image. A missing marker is predicted for two more images.
  void update(const FoundMarkers& found);
  void clear() { *this = {}; }  ///< removes all tracks

 private:
  struct Track {
    Detection last;
    Corners velocity;  // pixels per image
    bool moved;        // detected twice, so that it has its own velocity
    int missed;        // number of consecutive images without it
    bool followed;     // by a detection in the new image
  };
  Track follow(const Detection& detection);
  int depth(double speed) const;
  cv::Rect comingIn(double speed, const cv::Rect& side, const cv::Size& image,
                    const std::vector<cv::Rect>& cut_off) const;
  void learnMotion();

  std::vector<Track> tracks_;
  Eigen::Vector2d velocity_{0, 0};  // mean of all moved markers, pixels per image
  double extent_ = 0;               // side of the largest of them, pixels
};

}  // namespace sextant
