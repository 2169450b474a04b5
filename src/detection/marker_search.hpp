// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "quad_search.hpp"
#include "sextant/detection/corner_refiner.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// Markers that were found so far in one image; one on both sides of its edge counts once, as the larger one.
class FoundMarkers {
 public:
  void add(const Detection& detection);
  /// Whether a marker covers this quad's middle.
  bool cover(const QuadCandidate& quad) const;
  /// Whether this one is among them.
  bool include(const MarkerKey& key, const Corners& near) const;

  std::vector<Detection> markers;
  size_t refined = 0;  ///< of them, the first ones: their corners are as good as they get
};

/// One backend: where it is told to look, it reads markers. Corners and their deviations are the backend's
/// own.
class MarkerSearch {
 public:
  virtual ~MarkerSearch() = default;
  /// As thorough as it can.
  virtual void everywhere(const cv::Mat& image, FoundMarkers& found) = 0;
  /// @param window inside the image
  /// @param side about the shortest side of the marker that is expected there, pixels
  virtual void within(const cv::Mat& image, const cv::Rect& window, double side, Effort effort,
                      FoundMarkers& found) = 0;
  /// Reads every quad that is no part of a marker found already.
  virtual void inside(const cv::Mat& image, QuadSearch& quads, Effort effort, FoundMarkers& found);
  /// Whether this marker is read with its corners just there.
  virtual bool isAt(const cv::Mat&, const MarkerKey&, const Corners&) { return false; }
  /// Whether isAt() can tell; else markers must be looked for.
  virtual bool readsInPlace() const { return false; }
  /// Shortest side of a marker that can be read in images of this size, pixels.
  virtual double minSide(const cv::Size& image) const = 0;
  virtual BorderSquare border(const MarkerKey& key) const = 0;
};

/// The part of the box, wider by margin pixels on all sides, that lies in the image.
cv::Rect widened(const cv::Rect& box, double margin, const cv::Size& image);
/// The quad with what is white about a marker.
cv::Rect windowOf(const QuadCandidate& quad, const cv::Size& image);
/// Whether the window ends where the image does.
bool touchesBorder(const cv::Rect& window, const cv::Size& image);

}  // namespace sextant
