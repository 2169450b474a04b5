// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
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

/// Residuals of a recording against a map estimate, and the noise of its images.
class MapFit {
 public:
  MapFit(MarkerRecording recording, double corner_sigma, double gate);

  MapEstimate estimate;

  /// With the measured corners.
  const MarkerRecording& measured() const { return measured_; }
  /// With corners corrected by the estimated errors of the cameras.
  const MarkerRecording& recording() const { return recording_; }
  const std::map<MarkerKey, std::vector<RecordedObservation>>& observations() const { return observations_; }
  /// Restarts without the observations of these markers and without estimates of noise and cameras.
  void begin(const std::set<MarkerKey>& excluded);
  void accept(MapEstimate adjusted);  ///< the new estimate
  /// Observations whose marker and instant have a pose in the estimate and which project into the image
  /// plane.
  std::vector<RecordedObservation> placed() const;
  /// Number of observations that are not placed or do not fit.
  size_t unexplained() const;
  /// Observations within the gate.
  std::vector<RecordedObservation> withinGate() const;
  bool fits(const RecordedObservation& each) const;  ///< whether an observation is within the gate
  /// Poses of the instants at which several markers and most observations fit; empty at all others.
  std::vector<InstantHypotheses> explained() const;
  /// Poses of the instants of these observations.
  std::vector<InstantHypotheses> posesOf(const std::vector<RecordedObservation>& observations) const;
  InstantHypotheses poseAt(size_t instant) const;  ///< the estimated pose, which must exist

  /// Estimates the noise of every camera and image, see CornerNoise.
  void measureNoise(const std::vector<RecordedObservation>& used);
  /// Median factor on corner_sigma for each camera.
  std::vector<double> noiseScales() const;
  /// Root mean square displacement over the image by each camera's estimated error, pixels.
  std::vector<double> lensErrors() const;
  /// See correlatedImages().
  double correlation(const std::vector<RecordedObservation>& used) const;

  ObservationResidual residual(const RecordedObservation& each) const;

 private:
  using ImageIndex = std::pair<size_t, size_t>;  // instant, view
  using Offsets = Eigen::Matrix<double, 8, 1>;   // x and y of four corners, pixels

  const MarkerView& viewOf(const ImageIndex& image) const {
    return recording_[image.first].views[image.second];
  }
  bool isPlaced(const RecordedObservation& each) const;
  double squaredDistance(const RecordedObservation& each) const;
  std::optional<Offsets> pixels(const RecordedObservation& each) const;
  std::map<ImageIndex, ImageNoise> imageNoises(const std::vector<RecordedObservation>& used) const;

  MarkerRecording measured_, recording_;
  double corner_sigma_, gate_;
  std::map<MarkerKey, std::vector<RecordedObservation>> observations_;
  CornerNoise noise_;
};

}  // namespace sextant
