// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_tracker.hpp"

#include <algorithm>

namespace sextant {
namespace {

constexpr int kSweep = 3;           // period of searches for quads in the whole image, images
constexpr double kOutside = 1;      // pixels by which a corner may be outside the image
constexpr double kPredicted = 1.5;  // pixels; standard deviation of a predicted corner

cv::Rect boundingBox(const Corners& corners) {
  Eigen::Vector2d low = corners[0], high = corners[0];
  for (const auto& corner : corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const cv::Point2d begin(low.x(), low.y()), end(high.x(), high.y());
  return {cv::Point(begin), cv::Point(end) + cv::Point(1, 1)};
}

bool leaves(const cv::Mat& image, const Corners& corners) {
  return std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
    return corner.x() < -kOutside || corner.y() < -kOutside || corner.x() > image.cols - 1 + kOutside ||
           corner.y() > image.rows - 1 + kOutside;
  });
}

}  // namespace

std::vector<Detection> MarkerTracker::find(const cv::Mat& image, const CameraModel* camera) {
  FoundMarkers found;
  if (!tracking_ || image.size() != size_) {
    size_ = image.size();
    tracks_.clear();
    cut_off_.clear();
    search_->everywhere(image, found);
  } else {
    follow(image, camera, found);
  }
  for (size_t i = found.refined; refine_ && i < found.markers.size(); ++i)
    refine(image, camera, found.markers[i]);
  found.markers.erase(std::remove_if(found.markers.begin(), found.markers.end(),
                                     [&](const Detection& marker) { return leaves(image, marker.corners); }),
                      found.markers.end());
  if (tracking_) tracks_.update(found);
  return std::move(found.markers);
}

// A sweep comes before the search of single markers, because it finds most of them; if all markers are lost,
// a sweep is due.
void MarkerTracker::follow(const cv::Mat& image, const CameraModel* camera, FoundMarkers& found) {
  const cv::Rect whole({0, 0}, image.size());
  const auto expected = tracks_.expect(image.size());
  if (refine_ && search_->readsInPlace())
    for (const auto& marker : expected) confirm(marker, image, camera, found);
  const bool due = ++since_sweep_ >= kSweep;
  if (due) sweep(image, whole, found);
  for (const auto& marker : expected) lookFor(marker, image, found);
  if (due) return;
  if (found.markers.empty() && !expected.empty()) return sweep(image, whole, found);
  for (const cv::Rect& strip : tracks_.entrances(image.size(), cut_off_)) sweep(image, strip, found);
}

void MarkerTracker::refine(const cv::Mat& image, const CameraModel* camera, Detection& marker) const {
  BorderSquare border = search_->border(marker.key);
  border.start_sigma = marker.corner_sigmas[0];
  const RefinedCorners refined = refineCorners(image, marker.corners, border, camera);
  marker.corners = refined.corners;
  marker.corner_sigmas = refined.sigmas;
}

void MarkerTracker::confirm(const MarkerTracks::Expected& expected, const cv::Mat& image,
                            const CameraModel* camera, FoundMarkers& found) const {
  if (!expected.steady) return;
  Detection marker;
  marker.key = expected.key;
  marker.corners = expected.corners;
  marker.corner_sigmas.fill(kPredicted);
  refine(image, camera, marker);
  for (const double sigma : marker.corner_sigmas)
    if (sigma >= kPredicted) return;
  if (found.include(marker.key, marker.corners)) return;  // two tracks of one id have merged
  if (!search_->isAt(image, marker.key, marker.corners)) return;
  found.markers.push_back(marker);
  ++found.refined;
}

void MarkerTracker::lookFor(const MarkerTracks::Expected& marker, const cv::Mat& image, FoundMarkers& found) {
  const double side = shortestSide(marker.corners);
  const cv::Rect box = boundingBox(marker.corners);
  const auto missing = [&] { return !found.include(marker.key, marker.corners); };
  if (missing())
    search_->within(image, widened(box, marker.margin, image.size()), side, Effort::quick, found);
  if (missing() && marker.steady)
    search_->within(image, widened(box, 3 * marker.margin, image.size()), side, Effort::thorough, found);
}

void MarkerTracker::sweep(const cv::Mat& image, const cv::Rect& part, FoundMarkers& found) {
  quads_.find(image, part, search_->minSide(image.size()), Effort::quick);
  if (part.size() == image.size()) {
    since_sweep_ = 0;
    cut_off_ = quads_.cutOff();
  }
  search_->inside(image, quads_, Effort::quick, found);
}

}  // namespace sextant
