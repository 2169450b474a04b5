// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/camera.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/localization/marker_innovation.hpp"
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/marker.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// The detections of one camera at one instant.
struct MarkerView {
  CameraModel camera;                     ///< calibration of the image
  Pose T_base_camera = Pose::Identity();  ///< pose of the camera in the base frame (extrinsics)
  std::vector<Detection> detections;      ///< markers detected in the image
  size_t camera_index = 0;                ///< index of the camera, the same in all its images
  double noise_scale = 1.0;               ///< factor on LocatorParams::corner_sigma, see CornerNoise
};

/// Standard deviation of the coordinates of each corner of a detection, pixels: corner_sigma times the view's
/// noise_scale, and the corner's own standard deviation added in quadrature.
CornerSigmas cornerSigmas(const MarkerView& view, const Detection& detection, double corner_sigma);

/// Parameters of MarkerLocator, described in fields().
struct LocatorParams {
  std::string mode = "joint";
  double corner_sigma = 0.3;
  double max_reprojection_error = 2.0;
  double robust_width = 5.0;
  double gate = 30.0;
  double floor_height_sigma = 0.0;
  double floor_tilt_sigma = 0.02;
  double min_probability = 0.999999;
  std::string ambiguous_pose = "inflate";
  std::vector<double> constant_covariance;

  ParamList fields();
};

/// A detection of a mapped marker, compared with the located pose.
struct LocatedMarker {
  MarkerKey key;            ///< family and id
  size_t camera_index;      ///< index of the camera
  bool used;                ///< false: an outlier, or ignored because it was moved
  double squared_distance;  ///< squared Mahalanobis distance of the eight corner coordinates
  double own_squares;       ///< the same at the pose that fits this marker best: 2 degrees of freedom
  double noise_scale;       ///< MarkerView::noise_scale of its view
  std::optional<MarkerInnovation> innovation;  ///< if the other markers determine a pose: relative to it
};

/// The pose of the base, with the markers from which it was computed.
struct LocatedPose {
  Pose T_map_base;                     ///< pose of the base in the map
  Matrix6d covariance;                 ///< position, rotation in the map's axes, order of PoseWithCovariance
  double reprojection_error = 0.0;     ///< RMS over the coordinates of the corners used, pixels
  double map_deviation = 0.0;          ///< RMS that the map's covariance alone leads one to expect, pixels
  double probability = 1.0;            ///< probability of this pose among all that explain the images
  std::vector<LocatedMarker> markers;  ///< detected mapped markers, used or not, with their residuals

  std::vector<MarkerKey> used() const;      ///< markers from which the pose was computed
  std::vector<MarkerKey> outliers() const;  ///< the other detected mapped markers
};

/// A pose, or the reason why there is none.
struct LocatorResult {
  std::optional<LocatedPose> pose;      ///< nothing if the base was not located
  std::string reason;                   ///< why there is no pose, for the user; empty with a pose
  std::optional<LocatedPose> rejected;  ///< a pose whose reprojection error is too large
  std::vector<MarkerKey> unmapped;      ///< detected, but not in the map
  std::vector<MarkerKey> repeated;      ///< detected more than once in one image, and therefore ignored
};

/// Locates a robot from mapped markers. T_map_base = T_map_marker T_camera_marker^-1 T_base_camera^-1:
///  nearest  the pose from the marker with the smallest z in its camera's frame;
///  average  the mean of the poses from each marker;
///  joint    the pose that minimizes the robust reprojection error of all corners of all markers, started
///           from both planar solutions of every marker.
class MarkerLocator {
 public:
  /// @throws std::invalid_argument as validate(LocatorParams).
  explicit MarkerLocator(const LocatorParams& params);

  /// Parameters given at construction.
  const LocatorParams& params() const { return params_; }

  /// Locates the base.
  /// @param views detections at one instant, one view per camera
  /// @param prior the previous pose, predicted by odometry: only resolves ambiguities
  /// @param ignored markers that are not used, because they were moved
  LocatorResult locate(const MarkerMap& map, const std::vector<MarkerView>& views,
                       const std::optional<PosePrior>& prior = std::nullopt,
                       const std::set<MarkerKey>& ignored = {}) const;

 private:
  LocatorParams params_;
};

/// Allowed values of LocatorParams::mode.
std::vector<std::string> locatorModes();

}  // namespace sextant
