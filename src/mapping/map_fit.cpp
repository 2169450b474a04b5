// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "sextant/mapping/map_growth.hpp"

namespace sextant {
namespace {

constexpr double kCertain = 1e-8;        // variance of poses that are considered exact, m^2 and rad^2
constexpr size_t kImagesForNoise = 200;  // images from which a camera's noise is estimated
constexpr int kMajority = 3;  // markers that fit, for each that does not, at an instant that is explained

}  // namespace

MapFit::MapFit(MarkerRecording recording, double corner_sigma, double gate)
    : measured_(std::move(recording)),
      recording_(measured_),
      corner_sigma_(corner_sigma),
      gate_(gate),
      observations_(observationsByMarker(recording_)) {}

void MapFit::begin(const std::set<MarkerKey>& excluded) {
  observations_ = observationsByMarker(recording_);
  for (const MarkerKey& key : excluded) observations_.erase(key);
  noise_.reset();
  for (RecordedInstant& instant : measured_)
    for (MarkerView& view : instant.views) view.noise_scale = 1.0;
  recording_ = measured_;
  estimate.lenses.clear();
}

void MapFit::accept(MapEstimate adjusted) {
  estimate = std::move(adjusted);
  for (size_t i = 0; i < recording_.size(); ++i)
    recording_[i] = correctedInstant(measured_[i], estimate.lenses);
}

size_t MapFit::unexplained() const {
  size_t all = 0;
  for (const auto& entry : observations_) all += entry.second.size();
  return all - withinGate().size();
}

bool MapFit::isPlaced(const RecordedObservation& each) const {
  return estimate.T_map_base[each.instant] && estimate.map.find(detectionOf(recording_, each).key) &&
         std::isfinite(squaredDistance(each));
}

std::vector<RecordedObservation> MapFit::placed() const {
  std::vector<RecordedObservation> all;
  for (const auto& entry : observations_)
    for (const RecordedObservation& each : entry.second)
      if (isPlaced(each)) all.push_back(each);
  return all;
}

std::vector<RecordedObservation> MapFit::withinGate() const {
  std::vector<RecordedObservation> all = placed();
  all.erase(std::remove_if(all.begin(), all.end(), [&](const auto& each) { return !fits(each); }), all.end());
  return all;
}

// Infinite for corners that do not project into the image plane.
double MapFit::squaredDistance(const RecordedObservation& each) const {
  const auto offsets = pixels(each);
  if (!offsets) return std::numeric_limits<double>::infinity();
  const MarkerView& view = viewOf({each.instant, each.view});
  const CornerSigmas sigmas = cornerSigmas(view, view.detections[each.detection], corner_sigma_);
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += offsets->segment<2>(2 * k).squaredNorm() / (sigmas[k] * sigmas[k]);
  return sum;
}

// With the typical noise of the camera: a blurred image's own noise would hide outliers.
bool MapFit::fits(const RecordedObservation& each) const {
  const MarkerView& view = viewOf({each.instant, each.view});
  const double factor = view.noise_scale / noise_.scale(view.camera_index);
  return squaredDistance(each) * factor * factor <= gate_;
}

InstantHypotheses MapFit::poseAt(size_t instant) const {
  return {{*estimate.T_map_base[instant], kCertain * Matrix6d::Identity(), 0, 0, {0, 1}, 0, 1}};
}

std::vector<InstantHypotheses> MapFit::explained() const {
  std::vector<int> fitting(recording_.size()), others(recording_.size());
  for (const RecordedObservation& each : placed()) ++(fits(each) ? fitting : others)[each.instant];
  std::vector<InstantHypotheses> path(recording_.size());
  for (size_t i = 0; i < path.size(); ++i)
    if (fitting[i] > 1 && fitting[i] > kMajority * others[i]) path[i] = poseAt(i);
  return path;
}

std::vector<InstantHypotheses> MapFit::posesOf(const std::vector<RecordedObservation>& observations) const {
  std::vector<InstantHypotheses> path(recording_.size());
  for (const RecordedObservation& each : observations)
    if (path[each.instant].empty()) path[each.instant] = poseAt(each.instant);
  return path;
}

// Degrees of freedom: eight coordinates minus the share of the fitted poses.
std::map<MapFit::ImageIndex, ImageNoise> MapFit::imageNoises(
    const std::vector<RecordedObservation>& used) const {
  std::map<size_t, double> of_instant;
  std::map<MarkerKey, double> of_marker;
  for (const RecordedObservation& each : used) {
    ++of_instant[each.instant];
    ++of_marker[detectionOf(recording_, each).key];
  }
  std::map<ImageIndex, ImageNoise> images;
  for (const RecordedObservation& each : used) {
    const double scale = viewOf({each.instant, each.view}).noise_scale;
    ImageNoise& image = images[{each.instant, each.view}];
    image.squares += squaredDistance(each) * scale * scale;
    image.degrees_of_freedom +=
        std::max(0.0, 8 - 6 / of_instant[each.instant] - 6 / of_marker[detectionOf(recording_, each).key]);
  }
  return images;
}

void MapFit::measureNoise(const std::vector<RecordedObservation>& used) {
  const auto images = imageNoises(used);
  noise_.reset();
  size_t count = 0;
  for (const auto& [image, noise] : images)
    if (count++ % (1 + images.size() / kImagesForNoise) == 0)
      noise_.add(viewOf(image).camera_index, {noise, {}});
  for (size_t i = 0; i < recording_.size(); ++i) {
    for (size_t v = 0; v < recording_[i].views.size(); ++v) {
      MarkerView& view = recording_[i].views[v];
      const auto image = images.find({i, v});
      view.noise_scale = image == images.end() ? noise_.scale(view.camera_index)
                                               : noise_.scale(view.camera_index, {image->second, {}});
      measured_[i].views[v].noise_scale = view.noise_scale;
    }
  }
}

std::vector<double> MapFit::noiseScales() const {
  size_t cameras = 0;
  for (const RecordedInstant& instant : recording_)
    for (const MarkerView& view : instant.views) cameras = std::max(cameras, view.camera_index + 1);
  std::vector<double> scales;
  for (size_t i = 0; i < cameras; ++i) scales.push_back(noise_.typical(i));
  return scales;
}

std::vector<double> MapFit::lensErrors() const {
  std::vector<double> errors(noiseScales().size());
  for (const RecordedInstant& instant : recording_)
    for (const MarkerView& view : instant.views)
      if (const auto lens = estimate.lenses.find(view.camera_index);
          lens != estimate.lenses.end() && errors[view.camera_index] == 0)
        errors[view.camera_index] = lensDisplacement(view.camera, lens->second);
  return errors;
}

double MapFit::correlation(const std::vector<RecordedObservation>& used) const {
  std::map<std::pair<MarkerKey, size_t>, ResidualSeries> series;
  for (const RecordedObservation& each : used) {
    const MarkerView& view = viewOf({each.instant, each.view});
    series[{detectionOf(recording_, each).key, view.camera_index}][each.instant] =
        *pixels(each) / view.noise_scale;
  }
  std::vector<ResidualSeries> all;
  std::set<MarkerKey> markers;
  for (const auto& [marker_camera, residuals] : series) {
    all.push_back(residuals);
    markers.insert(marker_camera.first);
  }
  return correlatedImages(all, 6.0 * static_cast<double>(markers.size()));
}

// Nothing if a corner does not project into the image plane.
std::optional<MapFit::Offsets> MapFit::pixels(const RecordedObservation& each) const {
  const MarkerView& view = viewOf({each.instant, each.view});
  const Detection& detection = view.detections[each.detection];
  const MappedMarker& marker = *estimate.map.find(detection.key);
  const Pose T_map_camera = *estimate.T_map_base[each.instant] * view.T_base_camera;
  const Pose T_camera_marker = T_map_camera.inverse() * marker.T_map_marker;
  const auto points = markerCorners(marker.size);
  Offsets offsets;
  for (int k = 0; k < 4; ++k) {
    const auto seen = view.camera.project(T_camera_marker * points[k]);
    if (!seen) return std::nullopt;
    offsets.segment<2>(2 * k) = *seen - detection.corners[k];
  }
  return offsets;
}

ObservationResidual MapFit::residual(const RecordedObservation& each) const {
  return {each, fits(each), squaredDistance(each), std::sqrt(pixels(each)->squaredNorm() / 8)};
}

}  // namespace sextant
