// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/mapping/map_maker.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Compares every known marker that is not exact with the recording, without the marker's own prior.
/// @param held priors of the markers at the minimum
/// @param map the markers at the minimum; covariance: their joint covariance, six rows per marker
std::vector<KnownMarkerCheck> checkKnown(const MarkerMap& held, const MarkerMap& map,
                                         const Eigen::MatrixXd& covariance);

/// Factors on the standard deviations of known markers.
struct KnownScales {
  double position = 1.0, rotation = 1.0;
};

/// Estimates the factors with which the known markers have the expected median distance from the recording; 1
/// if it is not larger than expected, or for too few markers.
/// @param known with the standard deviations to scale; held, map, covariance: as for checkKnown()
KnownScales knownScales(const MarkerMap& known, const MarkerMap& held, const MarkerMap& map,
                        const Eigen::MatrixXd& covariance);

/// The known markers with scaled covariances.
MarkerMap scaledKnown(const MarkerMap& known, const KnownScales& scales);

/// The known markers with larger covariances for the first adjustment: a marker given as exact may be wrong,
/// and must not distort the others.
MarkerMap loosenedKnown(const MarkerMap& known);

MarkerMap withoutMarker(const MarkerMap& map, const MarkerKey& key);  ///< the map without a marker

}  // namespace sextant
