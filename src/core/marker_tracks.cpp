// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

constexpr int kPatience = 3;          // images for which a missed marker is expected on
constexpr double kQuiet = 0.15;       // of a side: the white about a marker, and how it may change
constexpr double kUnsteady = 0.3;     // of a velocity, which may change
constexpr double kStart = 0.03;       // of the image's width: a marker seen once only may move by it
constexpr double kEntrance = 1.3;     // depth of an entrance over the largest marker's side
constexpr int kBorder = 8;            // pixels, likewise: a marker must be in the image with its white
constexpr double kStill = 2.0;        // pixels an image
constexpr double kLeastMargin = 6.0;  // pixels

Corners shifted(Corners corners, const Eigen::Vector2d& by) {
  for (auto& corner : corners) corner += by;
  return corners;
}

}  // namespace

std::vector<MarkerTracks::Expected> MarkerTracks::expect(const cv::Size& image) const {
  std::vector<Expected> expected;
  for (const Track& track : tracks_) {
    const int images = track.missed + 1;
    Expected next{track.last.key, shifted(track.last.corners, images * velocity_), 0};
    if (track.moved)
      for (int i = 0; i < 4; ++i) next.corners[i] = track.last.corners[i] + images * track.velocity[i];
    const Eigen::Vector2d middle = centre(next.corners);
    if (middle.x() < 0 || middle.y() < 0 || middle.x() >= image.width || middle.y() >= image.height) continue;
    const double speed =
        track.moved ? centre(track.velocity).norm() : kStart * image.width + velocity_.norm();
    next.margin = kLeastMargin + kQuiet * perimeter(next.corners) / 4 + images * kUnsteady * speed;
    expected.push_back(next);
  }
  return expected;
}

std::vector<cv::Rect> MarkerTracks::entrances(const cv::Size& image) const {
  const auto depth = [&](double speed, int limit) {
    return std::min(static_cast<int>(kEntrance * extent_ + std::abs(speed)) + kBorder, limit);
  };
  std::vector<cv::Rect> strips;
  if (const int deep = depth(velocity_.x(), image.width); std::abs(velocity_.x()) > kStill)
    strips.emplace_back(velocity_.x() > 0 ? 0 : image.width - deep, 0, deep, image.height);
  if (const int deep = depth(velocity_.y(), image.height); std::abs(velocity_.y()) > kStill)
    strips.emplace_back(0, velocity_.y() > 0 ? 0 : image.height - deep, image.width, deep);
  return strips;
}

void MarkerTracks::update(const FoundMarkers& found) {
  std::vector<Track> next;
  for (const Detection& detection : found.markers) next.push_back(follow(detection));
  for (Track& track : tracks_)
    if (++track.missed <= kPatience && !found.include(track.last.key, track.last.corners))
      next.push_back(track);
  tracks_ = std::move(next);
  learnMotion();
}

MarkerTracks::Track MarkerTracks::follow(const Detection& detection) const {
  Track next{detection, {}, false, 0};
  double nearest = std::numeric_limits<double>::infinity();
  for (const Track& track : tracks_) {
    const double distance = (centre(track.last.corners) - centre(detection.corners)).norm();
    if (!(track.last.key == detection.key) || distance > nearest) continue;
    nearest = distance;
    next.moved = true;
    for (int i = 0; i < 4; ++i)
      next.velocity[i] = (detection.corners[i] - track.last.corners[i]) / (track.missed + 1);
  }
  return next;
}

// Where nothing is seen that moved, the motion is taken to go on.
void MarkerTracks::learnMotion() {
  Eigen::Vector2d sum(0, 0);
  double extent = 0;
  int count = 0;
  for (const Track& track : tracks_) {
    if (!track.moved) continue;
    sum += centre(track.velocity);
    extent = std::max(extent, perimeter(track.last.corners) / 4);
    ++count;
  }
  if (count == 0) return;
  velocity_ = sum / count;
  extent_ = extent;
}

}  // namespace sextant
