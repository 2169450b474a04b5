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
#include "sextant/localization/pose_hypotheses.hpp"
#include "sextant/markers/marker.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// What one camera saw at one instant.
struct MarkerView {
  CameraModel camera;
  Pose T_base_camera = Pose::Identity();  ///< mount
  std::vector<Detection> detections;
  size_t camera_index = 0;   ///< which of the robot's cameras: the same in every image of it
  double noise_scale = 1.0;  ///< factor on LocatorParams::corner_sigma, see CornerNoise
};

/// Standard deviation of the coordinates of each corner of a detection, pixels: what all corners of its view
/// have in common (corner_sigma, scaled by the view's noise) and what each tells of itself. A hidden one
/// counts little.
CornerSigmas cornerSigmas(const MarkerView& view, const Detection& detection, double corner_sigma);

struct LocatorParams {
  std::string mode = "joint";
  double corner_sigma = 0.3;
  double max_reprojection_error = 2.0;
  double robust_width = 5.0;
  double gate = 30.0;
  double floor_height_sigma = 0.0;
  double floor_tilt_sigma = 0.02;
  double decided = 0.999999;
  std::string ambiguous = "cover";
  std::vector<double> constant_covariance;

  ParamList fields();
};

/// What the other markers of an image say of one.
struct MarkerInnovation {
  double squared;         ///< Mahalanobis distance of its eight coordinates from where they are expected
  Eigen::Vector3d p_map;  ///< where its centre is seen, metres
  Eigen::Matrix3d p_covariance;  ///< of that
};

/// A mapped marker that was seen, against the pose that was found.
struct LocatedMarker {
  MarkerKey key;
  size_t camera_index;      ///< of the camera that saw it
  bool used;                ///< false: left out, since it stands elsewhere than the others say
  double squared_distance;  ///< Mahalanobis, of its eight coordinates
  double noise_scale;       ///< of its view
  std::optional<MarkerInnovation> innovation;  ///< joint: nothing where it is alone
};

/// Where the base is, and how that is known.
struct LocatedPose {
  Pose T_map_base;
  Matrix6d covariance;              ///< position, rotation in the map's axes, order of PoseWithCovariance
  double reprojection_error = 0.0;  ///< RMS over the coordinates of the corners used, pixels
  double probability = 1.0;         ///< of the pose against the others that explain the image
  std::vector<LocatedMarker> markers;

  std::vector<MarkerKey> used() const;
  std::vector<MarkerKey> leftOut() const;
};

/// Either a pose or the reason why there is none.
struct LocatorResult {
  std::optional<LocatedPose> pose;
  std::string reason;               ///< for the operator; empty with a pose
  std::vector<MarkerKey> unmapped;  ///< seen, but not in the map
  std::vector<MarkerKey> repeated;  ///< seen more than once in one image: left out, one of them must be wrong
};

/// Locates a robot from mapped markers (spec: T_map_base = T_map_marker inverse(T_camera_marker)
/// inverse(T_base_camera)):
///  nearest  the marker with the smallest z in its camera's frame;
///  average  the mean of the poses from every marker;
///  joint    the pose that minimizes the robust reprojection error of all corners of all markers, started
///  from both planar
///           poses of every marker.
class MarkerLocator {
 public:
  /// @throws std::invalid_argument as validate(LocatorParams).
  explicit MarkerLocator(const LocatorParams& params);

  const LocatorParams& params() const { return params_; }

  /// @param views of one instant, one a camera
  /// @param prior the last pose moved by odometry: it decides where the markers do not, and is not mixed in
  /// @param distrusted markers that are left out, whatever they say
  LocatorResult locate(const MarkerMap& map, const std::vector<MarkerView>& views,
                       const std::optional<PosePrior>& prior = std::nullopt,
                       const std::set<MarkerKey>& distrusted = {}) const;

 private:
  LocatorParams params_;
};

/// Names that LocatorParams::mode takes.
std::vector<std::string> locatorModes();

}  // namespace sextant
