// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/localization/odometry_correction.hpp"
#include "sextant/mapping/conflicting_poses.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

/// Parameters of makeMarkerMap().
struct MappingParams {
  double corner_sigma = 0.3;
  bool estimate_noise = true;
  double lens_sigma = 0.5;
  double robust_width = 5.0;
  double gate = 30.0;
  double min_probability = 0.999;
  double floor_height_sigma = 0.0;
  double floor_tilt_sigma = 0.02;
  OdometryParams odometry;  ///< of the odometry between two instants
  int threads = 1;

  ParamList fields();
};

/// Residuals of an observation against the map.
struct ObservationResidual {
  RecordedObservation observation;  ///< which detection
  bool used;                        ///< false: outside the gate
  double squared_distance;  ///< sum of the squared residuals over their variances, x and y of four corners
  double rms;               ///< root mean square residual of x and y of the four corners, pixels
};

/// A previously known marker, compared with the recording.
struct KnownMarkerCheck {
  MarkerKey key;    ///< family and id
  Vector6d offset;  ///< pose from the recording alone minus known pose: position, rotation in the map's axes
  double squared_distance;  ///< the larger of the squared Mahalanobis distances of position and of rotation,
                            ///< each with 3 degrees of freedom
  bool wrong;               ///< contradicts the recording; the known pose was not used
};

/// A map made from a recording, with diagnostics.
struct MappingResult {
  MarkerMap map;                     ///< with covariances
  Eigen::MatrixXd covariance;        ///< joint, in the order of map.markers(), six rows per marker
  BasePath T_map_base;               ///< poses of the base, one per instant
  std::vector<double> noise_scales;  ///< estimated factor on corner_sigma for each camera
  /// Estimated error of each camera's calibration: root mean square displacement over its image, pixels.
  std::vector<double> lens_errors;
  double correlated_images = 1.0;  ///< number of consecutive images that count as one, see correlatedImages()
  double known_position_scale = 1.0;  ///< factor on the standard deviations of the known markers' positions
  double known_rotation_scale = 1.0;  ///< factor on the standard deviations of the known markers' rotations
  /// Of every observation of a mapped marker at a keyframe with a pose, see keyframes().
  std::vector<ObservationResidual> residuals;
  std::vector<KnownMarkerCheck> known;  ///< observed known markers with a covariance
  /// Not in the map: two poses explain their observations, or none explains enough of them.
  std::vector<MarkerKey> ambiguous;
  /// Not in the map: no usable image or odometry connects them with the others.
  std::vector<MarkerKey> unconnected;
  /// Not in the map: moved during the recording, or the id is used twice.
  std::vector<MarkerKey> inconsistent;
  std::vector<ConflictingPose> conflicting_poses;  ///< of markers in the map
};

/// Makes a marker map from a recording: traverses the graph of observations, adding each marker once its pose
/// is unambiguous, then adjusts all poses to all corners (bundle adjustment).
/// @param sizes of the markers that are not known
/// @param known markers that define the frame, by their covariance or exactly; if empty, the marker with the
/// lowest family and id of the largest connected group is upright at the origin, facing along -y; with a
/// floor, only its x, y and heading are fixed
/// @throws std::invalid_argument as validate(MappingParams)
/// @throws std::runtime_error with the reason if no marker can be located
MappingResult makeMarkerMap(MarkerRecording recording, const MarkerSizes& sizes, const MarkerMap& known,
                            const MappingParams& params);

}  // namespace sextant
