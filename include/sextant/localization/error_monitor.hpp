// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <set>
#include <vector>

#include "sextant/localization/camera_errors.hpp"
#include "sextant/localization/error_sums.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// What makes residuals systematic.
enum class ErrorCause { focal_length, centre, distortion, shutter, marker_size, map };

/// A systematic error that explains the residuals of many images.
struct SystematicError {
  ErrorCause cause;   ///< what is wrong
  size_t camera = 0;  ///< index of the camera, if it is an error of a camera
  /// As in CameraErrors; logarithm of the marker size's factor; standard deviations of the position (m) and
  /// the rotation (rad) of mapped markers.
  Eigen::VectorXd value;
  Eigen::VectorXd sigma;  ///< standard deviation of each value; of the map: zero
};

/// Finds errors of calibration, shutter, marker size and map in the residuals of joint poses, with their
/// covariance. Each cause is a model with a prior for its errors; it is accepted if its evidence (marginal
/// likelihood) is clearly larger than without it, the one with the largest evidence first, and dropped when
/// the images do not need it any more. A moved marker is one of the models, but its errors are not estimated:
/// the caller is to ignore the marker.
class ErrorMonitor {
 public:
  /// Adds an image, or all images of one instant, and evaluates the causes from time to time. Ignored with
  /// less than two markers. @param weight below 1 for an image that is not independent of earlier ones
  void add(const std::vector<MonitoredMarker>& markers, double weight);
  void evaluate();  ///< evaluates the causes now

  /// The accepted errors, in the order of their acceptance.
  std::vector<SystematicError> errors() const;
  /// Estimated errors of a camera; zero if none was accepted.
  CameraErrors cameraErrors(size_t camera) const;
  /// Estimated true size of the markers over that of the map.
  double sizeFactor() const;
  /// The marker with its estimated size, and with the covariance of an inexact map. Its pose is not changed:
  /// the images determine how the markers are placed relative to each other, but not in the map.
  MappedMarker corrected(const MappedMarker& marker) const;
  /// Returns, once, the markers that were found not to be at their position in the map, by more than any
  /// other cause explains.
  std::set<MarkerKey> takeMoved();

  /// What the uncertainty of the accepted errors adds to the covariance of a pose.
  /// @param information of the pose from these markers; weights: S^-1 of linearization.covariance
  Matrix6d poseCovariance(const std::vector<MonitoredMarker>& markers, const Matrix6d& information) const;

  /// Whether causes were accepted or dropped: the images so far are to be added again, located with the
  /// errors of now, between beginReplay() and evaluate().
  bool needsReplay() const { return needs_replay_; }
  void beginReplay();  ///< forgets all images

  void reset() { *this = ErrorMonitor(); }  ///< forgets everything

 private:
  struct Cause {
    ErrorCause kind;
    size_t camera = 0;
  };
  struct Model {
    ErrorPrior prior;
    ErrorFit fit;
  };

  struct MostMoved {
    double gain, second;  // of the logarithm of the evidence; that of the next marker
    MarkerKey marker;
  };

  std::vector<std::vector<Cause>> candidates(const std::vector<Cause>& accepted) const;
  // First of the columns of a cause's errors; not of the map.
  Eigen::Index firstColumn(const Cause& cause) const;
  void addErrors(const Cause& cause, ErrorPrior& prior) const;
  ErrorPrior priorOf(const std::vector<Cause>& causes, const Eigen::Vector2d& map_sigmas) const;
  Model modelOf(const std::vector<Cause>& causes, const Eigen::Vector2d& map_sigmas) const;
  double gainOf(const Model& now, const std::vector<Cause>& added, Eigen::Vector2d& map_sigmas) const;
  bool findMoved();
  bool findMoved(const std::vector<Cause>& causes);
  MostMoved mostMoved(const Model& now) const;
  ErrorPrior withMoved(ErrorPrior prior, const MarkerKey& marker) const;
  bool isFarAway(const Model& now, const MarkerKey& marker) const;
  bool accept();
  bool dropOne();
  void apply(const Model& model);
  void fitMapSigmas(const Model& model);
  bool accepts(ErrorCause kind) const;

  ErrorSums sums_;
  std::map<MarkerKey, Matrix6d> map_covariances_;
  std::vector<Cause> accepted_;
  ErrorPrior posterior_;                    // errors of cameras and marker size: covariance
  Eigen::Vector2d map_sigmas_{0.01, 0.01};  // m, rad
  std::set<MarkerKey> moved_;
  int images_ = 0, evaluated_ = 0,
      next_ = 0;     // number of images: so far, at the last evaluation, at the next
  int replays_ = 0;  // since the last change of the images
  bool needs_replay_ = false;
};

}  // namespace sextant
