// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "map_fit.hpp"
#include "sextant/mapping/map_maker.hpp"
#include "sextant/mapping/recorded_path.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/observed_marker.hpp"

namespace sextant {

/// A draft of the map, in which all ambiguities are resolved and inconsistent markers are excluded, and its
/// stepwise adjustment.
class MapDraft {
 public:
  MapDraft(MarkerRecording recording, const MarkerSizes& sizes, const MarkerMap& known,
           const MappingParams& params);

  /// Grows the map from the known markers, adjusts it with a robust loss, and excludes inconsistent markers.
  /// @throws std::runtime_error if nothing is connected
  void make();

  /// Adjusts the map. @param robust_width 0: no robust loss
  /// @throws std::runtime_error if the minimization fails
  void adjust(const std::vector<RecordedObservation>& used, double robust_width);
  /// Locates the instants without any of these observations.
  void locateRemainingInstants(const std::vector<RecordedObservation>& used);
  /// Poses at all instants of a recording, of which those at the keyframes were estimated.
  BasePath pathOf(MarkerRecording whole, const std::vector<size_t>& keyframes) const;
  /// Observations with information about the map: an instant with one marker has none, unless odometry or the
  /// floor constrains it.
  std::vector<RecordedObservation> informative(const std::vector<RecordedObservation>& all) const;
  AdjustmentParams adjustment(double robust_width) const;

  MapFit fit;
  MarkerMap known;                 ///< known markers, or the first marker
  MarkerMap held;                  ///< markers that define the frame, with scaled covariances
  double correlated_images = 1.0;  ///< see correlatedImages()
  /// Not in the map: two poses explain their observations, or none explains enough of them.
  std::set<MarkerKey> ambiguous;
  std::set<MarkerKey> inconsistent;  ///< not in the map: no single pose explains their observations
  std::vector<ConflictingPose> conflicting_poses;

 private:
  void draft();
  void grow();
  bool isFirstToBlame() const;
  bool excludeInconsistent();
  bool draftWithout(const MarkerKey& key);
  void findContradictions();
  std::vector<MarkerKey> suspects() const;
  PathParams path(const std::optional<FloorPrior>& floor) const;
  bool mendBranches();
  bool mend(std::optional<Pose>& pose, const InstantHypotheses& found) const;
  bool mendMarker(const MarkerKey& key, const std::vector<RecordedObservation>& observations,
                  const std::vector<InstantHypotheses>& bases);

  const MarkerSizes* sizes_;  // not owned; pointers make drafts assignable
  const MappingParams* params_;
  bool frameless_;
  std::optional<FloorPrior> floor_;
};

}  // namespace sextant
