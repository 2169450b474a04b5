// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose.hpp"
#include "sextant/localization/odometry_correction.hpp"
#include "sextant/mapping/marker_recording.hpp"
#include "sextant/mapping/second_places.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

struct MappingParams {
  double corner_sigma = 0.3;
  bool estimate_noise = true;
  double robust_width = 5.0;
  double gate = 30.0;
  double decided = 0.999;
  double floor_height_sigma = 0.0;
  double floor_tilt_sigma = 0.02;
  OdometryParams odometry;
  int threads = 1;

  ParamList fields();
};

/// A sighting against the map that was made.
struct SightingResidual {
  RecordedSighting sighting;
  bool used;                ///< false: left out, since it does not fit
  double squared_distance;  ///< of its eight coordinates over their deviations
  double rms;               ///< of its eight coordinates, pixels
};

/// A marker that was known before, against what the recording says of it.
struct KnownMarkerCheck {
  MarkerKey key;
  Vector6d offset;          ///< where all else sees it minus where it was known: position, rotation in the
                            ///< map's axes
  double squared_distance;  ///< of the worse of position and rotation, Mahalanobis, 3 degrees of freedom
  bool wrong;               ///< it stands elsewhere, and what was known of it was not used
};

/// A map, and what it was made of.
struct MadeMap {
  MarkerMap map;               ///< with covariances
  Eigen::MatrixXd covariance;  ///< of all markers together, in the order of map.markers(), six rows a marker
  BasePath T_map_base;
  std::vector<double> noise_scales;   ///< factor on corner_sigma, camera by camera
  double correlated_images = 1.0;     ///< so many in a row say as much as one, see correlatedImages()
  double known_position_scale = 1.0;  ///< what the known markers' deviations had to be multiplied by
  double known_rotation_scale = 1.0;
  std::vector<SightingResidual> residuals;
  std::vector<KnownMarkerCheck> known;     ///< those with a covariance that were seen
  std::vector<MarkerKey> ambiguous;        ///< left out: two places explain what was seen of them
  std::vector<MarkerKey> unconnected;      ///< left out: never seen together with the others
  std::vector<MarkerKey> twice;            ///< left out: moved during the recording, or printed twice
  std::vector<SecondPlace> second_places;  ///< of markers that are in the map
};

/// Makes a marker map of a recorded drive: initial poses over the graph of sightings with every ambiguity
/// resolved, then bundle adjustment over all corners.
/// @param sizes of the markers that are not known
/// @param known markers that hold the frame, by their covariance or exactly; if empty, one that is connected
/// to most others hangs upright in the origin, and looks along -y
/// @throws std::invalid_argument as validate(MappingParams)
/// @throws std::runtime_error when no marker can be placed, with the reason
MadeMap makeMarkerMap(MarkerRecording recording, const MarkerSizes& sizes, const MarkerMap& known,
                      const MappingParams& params);

}  // namespace sextant
