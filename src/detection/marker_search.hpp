// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "quad_search.hpp"
#include "sextant/detection/corner_refiner.hpp"
#include "sextant/detection/marker_detector.hpp"
#include "sextant/markers/marker.hpp"

namespace sextant {

/// The markers detected so far in one image. A marker detected at both sides of its border is kept once, with
/// the larger outline.
class FoundMarkers {
 public:
  void add(const Detection& detection);
  /// Whether a marker covers the centre of this quad.
  bool cover(const QuadCandidate& quad) const;
  /// Whether this marker is among them, near these corners.
  bool include(const MarkerKey& key, const Corners& near) const;

  std::vector<Detection> markers;
  size_t refined = 0;  ///< number of markers, from the first, whose corners are final
};

/// A detector backend: reads markers in parts of an image, with the backend's own corners and deviations.
class MarkerSearch {
 public:
  virtual ~MarkerSearch() = default;
  /// Searches the whole image as thoroughly as possible.
  virtual void everywhere(const cv::Mat& image, FoundMarkers& found) = 0;
  /// Searches a part of the image.
  /// @param window inside the image
  /// @param side approximate shortest side of the expected marker, pixels
  virtual void within(const cv::Mat& image, const cv::Rect& window, double side, Effort effort,
                      FoundMarkers& found) = 0;
  /// Reads every quad that is not part of a detected marker.
  virtual void inside(const cv::Mat& image, QuadSearch& quads, Effort effort, FoundMarkers& found);
  /// Whether this marker can be read with exactly its corners; then sets what the backend knows of its bits.
  virtual bool readAt(const cv::Mat&, Detection&) { return false; }
  /// Whether readAt() is implemented; else markers must be searched.
  virtual bool readsInPlace() const { return false; }
  /// Shortest side of a marker that can be read in images of this size, pixels.
  virtual double minSide(const cv::Size& image) const = 0;
  /// The outer square of a marker.
  virtual BorderSquare border(const MarkerKey& key) const = 0;
};

/// Creates a search with libapriltag, for several of its families in one pass.
/// @throws std::out_of_range for an unknown family
/// @throws std::invalid_argument if the table of corrected codes would not fit in memory
std::unique_ptr<MarkerSearch> makeAprilTagSearch(const DetectorParams& params,
                                                 const std::vector<std::string>& families);
/// Creates a search with OpenCV's aruco module, for one dictionary.
/// @param dictionary its canonicalFamily()
/// @throws std::out_of_range for an unknown dictionary
std::unique_ptr<MarkerSearch> makeArucoSearch(const DetectorParams& params, const std::string& dictionary);

/// The box widened by margin pixels on all sides and clipped to the image.
cv::Rect widened(const cv::Rect& box, double margin, const cv::Size& image);
/// A window around the quad with the white margin of a marker.
cv::Rect windowOf(const QuadCandidate& quad, const cv::Size& image);
/// Whether the window touches the border of the image.
bool touchesBorder(const cv::Rect& window, const cv::Size& image);

}  // namespace sextant
