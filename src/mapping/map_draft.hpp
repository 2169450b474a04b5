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

/// A map in which every marker is on the right branch and no false one is left: what is to be adjusted. Then
/// it is adjusted step by step.
class MapDraft {
 public:
  MapDraft(MarkerRecording recording, const MarkerSizes& sizes, const MarkerMap& known,
           const MappingParams& params);

  /// Grows the map from the known markers, adjusts it with a robust loss, and leaves out markers that are in
  /// two places. @throws std::runtime_error when nothing is connected
  void make();

  /// @param robust_width 0: all sightings count as they are
  /// @throws std::runtime_error when the search fails
  void adjust(const std::vector<RecordedSighting>& used, double robust_width);
  /// Locates the instants of which none of these sightings is.
  void locateOthers(const std::vector<RecordedSighting>& used);
  /// Those that say something of the map: an instant with one marker does not, unless it is bound to others
  /// or to the floor.
  std::vector<RecordedSighting> useful(const std::vector<RecordedSighting>& all) const;
  AdjustmentParams adjustment(double robust_width) const;

  MapFit fit;
  MarkerMap known;                 ///< what was told, or the first marker
  MarkerMap held;                  ///< what holds the frame, as far as it is believed
  double correlated_images = 1.0;  ///< see correlatedImages()
  std::set<MarkerKey> ambiguous;   ///< not in the map: two places explain them
  std::set<MarkerKey> twice;       ///< not in the map: they are in two places
  std::vector<SecondPlace> second_places;

 private:
  void draft();
  void grow();
  bool leaveOutWhatIsTwice();
  bool draftWithout(const MarkerKey& key);
  void findContradictions();
  std::vector<MarkerKey> suspects() const;
  PathParams path(const std::optional<FloorPrior>& floor) const;
  bool mendBranches();
  bool mend(std::optional<Pose>& pose, const InstantHypotheses& found) const;
  bool mendMarker(const MarkerKey& key, const std::vector<RecordedSighting>& sightings,
                  const std::vector<InstantHypotheses>& bases);

  const MarkerSizes* sizes_;  // not owned; pointers, so that a better draft can take this one's place
  const MappingParams* params_;
  bool frameless_;
  std::optional<FloorPrior> floor_;
};

}  // namespace sextant
