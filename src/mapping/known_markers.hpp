// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sextant/mapping/map_maker.hpp"
#include "sextant/markers/marker_map.hpp"

namespace sextant {

/// Every known marker that is not exact against what all but itself says at a minimum.
/// @param held what drew the markers there
/// @param map the markers at the minimum; covariance: theirs, six rows a marker
std::vector<KnownMarkerCheck> checkKnown(const MarkerMap& held, const MarkerMap& map,
                                         const Eigen::MatrixXd& covariance);

/// Factors on the deviations of known markers.
struct KnownScales {
  double position = 1.0, rotation = 1.0;
};

/// Those with which half of the known markers are as far off as half should be; 1 where they are no farther,
/// or too few to tell.
/// @param known with the deviations that are asked about; held, map, covariance: as of checkKnown()
KnownScales knownScales(const MarkerMap& known, const MarkerMap& held, const MarkerMap& map,
                        const Eigen::MatrixXd& covariance);

MarkerMap scaledKnown(const MarkerMap& known, const KnownScales& scales);

/// To begin with: what is told as exact may not be, and where several hold the frame none is to lead the
/// others astray.
MarkerMap loosenedKnown(const MarkerMap& known);

MarkerMap withoutMarker(const MarkerMap& map, const MarkerKey& key);

}  // namespace sextant
