// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marker_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

constexpr int kMaxMissed = 2;          // images for which a missing marker is predicted
constexpr double kQuietZone = 0.15;    // margin for the white border and changes of size, over a side
constexpr double kUnsteady = 0.3;      // margin for a change of velocity, over the velocity
constexpr double kFirstMotion = 0.03;  // margin for a marker detected once, over the image width
constexpr double kEntrance = 1.15;     // depth of an entrance over the largest marker's side
constexpr int kBorder = 8;             // pixels added to it: a marker must be inside with its white border
constexpr double kGrowth = 0.3;        // margin for an entering marker's growth and motion, over its size
constexpr double kStill = 2.0;         // pixels per image, below which the image is at rest
constexpr double kFast = 12.0;         // pixels per image; a narrow marker can enter between two sweeps
constexpr double kTrackMargin = 6.0;   // pixels

Corners shifted(Corners corners, const Eigen::Vector2d& by) {
  for (auto& corner : corners) corner += by;
  return corners;
}

}  // namespace

std::vector<MarkerTracks::Expected> MarkerTracks::expect(const cv::Size& image) const {
  std::vector<Expected> expected;
  for (const Track& track : tracks_) {
    const int images = track.missed + 1;
    Expected next{track.last.key, shifted(track.last.corners, images * velocity_), 0,
                  track.moved && track.missed == 0};
    if (track.moved)
      for (int i = 0; i < 4; ++i) next.corners[i] = track.last.corners[i] + images * track.velocity[i];
    const Eigen::Vector2d middle = centre(next.corners);
    if (middle.x() < 0 || middle.y() < 0 || middle.x() >= image.width || middle.y() >= image.height) continue;
    const double speed =
        track.moved ? centre(track.velocity).norm() : kFirstMotion * image.width + velocity_.norm();
    next.margin = kTrackMargin + kQuietZone * perimeter(next.corners) / 4 + images * kUnsteady * speed;
    expected.push_back(next);
  }
  return expected;
}

// Depth of an entrance strip, pixels.
int MarkerTracks::depth(double speed) const {
  return static_cast<int>(kEntrance * extent_ + std::abs(speed)) + kBorder;
}

// The whole strip for fast motion, else the outlines that were cut off at this side.
cv::Rect MarkerTracks::comingIn(double speed, const cv::Rect& side, const cv::Size& image,
                                const std::vector<cv::Rect>& cut_off) const {
  if (std::abs(speed) <= kStill) return {};
  if (std::abs(speed) > kFast) return {{0, 0}, image};
  cv::Rect all;
  for (const cv::Rect& box : cut_off)
    if ((box & side).area() > 0 && std::max(box.width, box.height) < 2 * depth(speed))
      all |= widened(box, kBorder + kGrowth * std::max(box.width, box.height), image);
  return all;
}

std::vector<cv::Rect> MarkerTracks::entrances(const cv::Size& image,
                                              const std::vector<cv::Rect>& cut_off) const {
  const auto begin = [](double speed, int limit, int depth) { return speed > 0 ? 0 : limit - depth; };
  const cv::Rect whole({0, 0}, image);
  const double vx = velocity_.x(), vy = velocity_.y();
  const cv::Rect upright =
      comingIn(vx, {begin(vx, image.width, kBorder), 0, kBorder, image.height}, image, cut_off);
  const cv::Rect level =
      comingIn(vy, {0, begin(vy, image.height, kBorder), image.width, kBorder}, image, cut_off);
  std::vector<cv::Rect> strips;
  if (!upright.empty())
    strips.push_back(whole &
                     cv::Rect(begin(vx, image.width, depth(vx)), upright.y, depth(vx), upright.height));
  if (!level.empty())
    strips.push_back(whole & cv::Rect(level.x, begin(vy, image.height, depth(vy)), level.width, depth(vy)));
  return strips;
}

void MarkerTracks::update(const FoundMarkers& found) {
  std::vector<Track> next;
  for (const Detection& detection : found.markers) next.push_back(follow(detection));
  for (Track& track : tracks_)
    if (!track.followed && ++track.missed <= kMaxMissed) next.push_back(track);
  tracks_ = std::move(next);
  learnMotion();
}

MarkerTracks::Track MarkerTracks::follow(const Detection& detection) {
  Track next{detection, {}, false, 0, false};
  Track* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (Track& track : tracks_) {
    const double distance = (centre(track.last.corners) - centre(detection.corners)).norm();
    if (!(track.last.key == detection.key) || distance > least) continue;
    least = distance;
    nearest = &track;
  }
  if (!nearest) return next;
  nearest->followed = next.moved = true;
  for (int i = 0; i < 4; ++i)
    next.velocity[i] = (detection.corners[i] - nearest->last.corners[i]) / (nearest->missed + 1);
  return next;
}

// Without moving markers, the last motion is kept.
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
