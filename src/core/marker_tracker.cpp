// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_tracker.hpp"

namespace sextant {
namespace {

constexpr int kSweep = 3;  // images within which a marker anywhere is found

cv::Rect boundingBox(const Corners& corners) {
  Eigen::Vector2d low = corners[0], high = corners[0];
  for (const auto& corner : corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const cv::Point2d begin(low.x(), low.y()), end(high.x(), high.y());
  return {cv::Point(begin), cv::Point(end) + cv::Point(1, 1)};
}

}  // namespace

std::vector<Detection> MarkerTracker::find(const cv::Mat& image) {
  FoundMarkers found;
  if (!tracking_ || image.size() != size_) {
    size_ = image.size();
    tracks_.clear();
    search_->everywhere(image, found);
  } else {
    follow(image, found);
  }
  if (tracking_) tracks_.update(found);
  return std::move(found.markers);
}

// A sweep comes first, since it finds most of what is expected; where that is all lost, one is due.
void MarkerTracker::follow(const cv::Mat& image, FoundMarkers& found) {
  const cv::Rect whole({0, 0}, image.size());
  const auto expected = tracks_.expect(image.size());
  const bool due = ++since_sweep_ >= kSweep;
  if (due) sweep(image, whole, found);
  for (const auto& marker : expected)
    if (!lookFor(marker, marker.margin, Effort::quick, image, found))
      lookFor(marker, 3 * marker.margin, Effort::thorough, image, found);
  if (due) return;
  if (found.markers.empty() && !expected.empty()) return sweep(image, whole, found);
  for (const cv::Rect& strip : tracks_.entrances(image.size())) sweep(image, strip, found);
}

bool MarkerTracker::lookFor(const MarkerTracks::Expected& marker, double margin, Effort effort,
                            const cv::Mat& image, FoundMarkers& found) {
  if (found.include(marker.key, marker.corners)) return true;
  const cv::Rect window = widened(boundingBox(marker.corners), margin, image.size());
  search_->within(image, window, shortestSide(marker.corners), effort, found);
  return found.include(marker.key, marker.corners);
}

void MarkerTracker::sweep(const cv::Mat& image, const cv::Rect& part, FoundMarkers& found) {
  if (part.size() == image.size()) since_sweep_ = 0;
  quads_.find(image, part, search_->minSide(image.size()), Effort::quick);
  search_->inside(image, quads_, Effort::quick, found);
}

}  // namespace sextant
