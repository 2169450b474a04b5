// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_tracker.hpp"

#include <algorithm>

namespace sextant {
namespace {

constexpr int kSweep = 3;           // period of searches for quads in the whole image, images
constexpr int kThoroughSweep = 10;  // period of thorough ones, sweeps; quick ones never find faint markers
constexpr double kOutside = 0.5;    // modules by which an edge may be outside the image, and at least a pixel
constexpr double kCrowded = 0.25;   // of the image's area: larger windows cost as much as a full search
constexpr double kThoroughMargin = 3;  // of a thorough search, in margins of the track
constexpr double kPredicted = 1.5;     // pixels; standard deviation of a predicted corner

cv::Rect boundingBox(const Corners& corners) {
  Eigen::Vector2d low = corners[0], high = corners[0];
  for (const auto& corner : corners) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const cv::Point2d begin(low.x(), low.y()), end(high.x(), high.y());
  return {cv::Point(begin), cv::Point(end) + cv::Point(1, 1)};
}

// How far the middle of an edge is outside the image, pixels. Where only a corner is outside, its edges meet
// there.
double edgeBeyond(const cv::Mat& image, const Corners& corners) {
  double most = 0;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d middle = 0.5 * (corners[i] + corners[(i + 1) % 4]);
    most = std::max(
        {most, -middle.x(), -middle.y(), middle.x() - (image.cols - 1), middle.y() - (image.rows - 1)});
  }
  return most;
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
                                     [&](const Detection& marker) { return leaves(image, marker); }),
                      found.markers.end());
  if (tracking_) tracks_.update(found);
  return std::move(found.markers);
}

bool MarkerTracker::leaves(const cv::Mat& image, const Detection& marker) const {
  const double module = perimeter(marker.corners) / 4 / search_->border(marker.key).modules;
  return edgeBeyond(image, marker.corners) > std::max(1.0, kOutside * module);
}

// A sweep comes before the search of single markers, because it finds most of them; if all markers are lost,
// a sweep is due. If the windows of many markers would cost more than a full search, that is done instead.
void MarkerTracker::follow(const cv::Mat& image, const CameraModel* camera, FoundMarkers& found) {
  const cv::Rect whole({0, 0}, image.size());
  const auto expected = tracks_.expect(image.size());
  if (refine_ && search_->readsInPlace())
    for (const auto& marker : expected) confirm(marker, image, camera, found);
  const bool due = ++since_sweep_ >= kSweep;
  if (due) sweep(image, whole, found);
  if (!lookFor(expected, image, found)) return search_->everywhere(image, found);
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
  if (!search_->readAt(image, marker)) return;
  found.markers.push_back(marker);
  ++found.refined;
}

bool MarkerTracker::lookFor(const std::vector<MarkerTracks::Expected>& expected, const cv::Mat& image,
                            FoundMarkers& found) {
  for (const Effort effort : {Effort::quick, Effort::thorough}) {
    const double margins = effort == Effort::quick ? 1 : kThoroughMargin;
    const auto is_missing = [&](const MarkerTracks::Expected& marker) {
      return (marker.steady || effort == Effort::quick) && !found.include(marker.key, marker.corners);
    };
    const auto window = [&](const MarkerTracks::Expected& marker) {
      return widened(boundingBox(marker.corners), margins * marker.margin, image.size());
    };
    double area = 0;
    for (const auto& marker : expected)
      if (is_missing(marker)) area += window(marker).area();
    if (area > kCrowded * static_cast<double>(image.total())) return false;
    for (const auto& marker : expected)
      if (is_missing(marker))
        search_->within(image, window(marker), shortestSide(marker.corners), effort, found);
  }
  return true;
}

void MarkerTracker::sweep(const cv::Mat& image, const cv::Rect& part, FoundMarkers& found) {
  const bool is_whole = part.size() == image.size();
  const bool is_thorough = is_whole && ++sweeps_ % kThoroughSweep == 0;
  quads_.find(image, part, search_->minSide(image.size()), is_thorough ? Effort::thorough : Effort::quick);
  if (is_whole) {
    since_sweep_ = 0;
    cut_off_ = quads_.cutOff();
  }
  search_->inside(image, quads_, Effort::quick, found);
}

}  // namespace sextant
