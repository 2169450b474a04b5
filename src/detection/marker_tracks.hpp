// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "marker_search.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// Where the markers of the last images should be in the next one: each goes on as it moved, or, as long as
/// it was seen once only, as the others do.
class MarkerTracks {
 public:
  struct Expected {
    MarkerKey key;
    Corners corners;  ///< pixels
    double margin;    ///< pixels about them in which the marker is looked for
    bool steady;      ///< seen in the last image, and before
  };

  /// Those whose centre should be in the image.
  std::vector<Expected> expect(const cv::Size& image) const;
  /// The parts of the image's sides that it moves away from in which a new marker can come in, deep enough
  /// for the largest one seen. Empty as long as nothing moves.
  /// @param cut_off boxes of what the image's border cut off up to three images ago: what comes in is one of
  /// it
  std::vector<cv::Rect> entrances(const cv::Size& image, const std::vector<cv::Rect>& cut_off) const;
  /// Learns from the next image. A marker that is missed is expected for some images more.
  void update(const FoundMarkers& found);
  void clear() { *this = {}; }

 private:
  struct Track {
    Detection last;
    Corners velocity;  // pixels an image
    bool moved;        // seen twice, so that it has a velocity of its own
    int missed;        // images in a row
  };
  Track follow(const Detection& detection) const;
  int depth(double speed) const;
  cv::Rect comingIn(double speed, const cv::Rect& side, const cv::Size& image,
                    const std::vector<cv::Rect>& cut_off) const;
  void learnMotion();

  std::vector<Track> tracks_;
  Eigen::Vector2d velocity_{0, 0};  // mean of all that moved, pixels an image
  double extent_ = 0;               // side of the largest one seen with it, pixels
};

}  // namespace sextant
