// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "sextant/localization/corner_noise.hpp"
#include "sextant/mapping/map_adjustment.hpp"
#include "sextant/mapping/map_maker.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/mapping/recorded_path.hpp"
#include "sextant/mapping/residual_correlation.hpp"

namespace sextant {

/// How a recording fits a map: which sightings do, and how noisy its images are.
class MapFit {
 public:
  MapFit(MarkerRecording recording, double corner_sigma, double gate);

  MapEstimate estimate;

  const MarkerRecording& recording() const { return recording_; }
  const std::map<MarkerKey, std::vector<RecordedSighting>>& sightings() const { return sightings_; }
  /// Begins anew: without these markers' sightings, and with nothing known of the noise.
  void begin(const std::set<MarkerKey>& left_out);

  /// Of all markers and instants that the estimate knows and brings before the lens.
  std::vector<RecordedSighting> placed() const;
  /// Of all sightings, those that are not placed or do not fit.
  size_t unexplained() const;
  /// Those within the gate.
  std::vector<RecordedSighting> fitting() const;
  bool fits(const RecordedSighting& each) const;

  /// Poses of the instants at which several markers fit, and none does not; empty at all others.
  std::vector<InstantHypotheses> explained() const;
  /// Poses of the instants of these sightings.
  std::vector<InstantHypotheses> posesOf(const std::vector<RecordedSighting>& sightings) const;

  /// What every image says of its noise, and what is usual for its camera: see CornerNoise.
  void measureNoise(const std::vector<RecordedSighting>& used);
  /// Factor on corner_sigma of most images, camera by camera.
  std::vector<double> noiseScales() const;
  /// See correlatedImages().
  double correlation(const std::vector<RecordedSighting>& used) const;

  SightingResidual residual(const RecordedSighting& each) const;

 private:
  using ImageIndex = std::pair<size_t, size_t>;  // instant, view

  const MarkerView& viewOf(const ImageIndex& image) const {
    return recording_[image.first].views[image.second];
  }
  bool isPlaced(const RecordedSighting& each) const;
  double squaredDistance(const RecordedSighting& each) const;
  Eigen::Matrix<double, 8, 1> pixels(const RecordedSighting& each) const;
  std::map<ImageIndex, ImageNoise> imageNoises(const std::vector<RecordedSighting>& used) const;
  InstantHypotheses poseAt(size_t instant) const;

  MarkerRecording recording_;
  double corner_sigma_, gate_;
  std::map<MarkerKey, std::vector<RecordedSighting>> sightings_;
  CornerNoise noise_;
};

}  // namespace sextant
