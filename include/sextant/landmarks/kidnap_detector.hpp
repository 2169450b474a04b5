// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <vector>

namespace sextant {

/// Declares the robot lost when established landmarks are not where they are predicted. New landmarks are
/// provisional until they have been observed together with established ones: they do not count as evidence.
/// Scans without any observation are not enough: the sensor may have failed.
class KidnapDetector {
 public:
  /// Result of the data association of one scan.
  struct Evidence {
    std::vector<int> observed;  ///< keys of the landmarks that were observed
    std::vector<int> missed;    ///< keys of landmarks in view that were not observed
    int contradictions = 0;     ///< observations that contradict the map
    int unknown = 0;            ///< observations of landmarks that are not in the map
    int next_key = 0;           ///< key of the next new landmark
    double miss_weight = 1;     ///< of a missed landmark, in scans: less for a sensor that misses many
    bool slipped = false;       ///< whether odometry is taken to have slipped before the scan
    bool is_complete = false;   ///< whether the map is complete: then unknown landmarks contradict it
  };

  /// @param lost_after number of scans that contradict the map, less those that confirm it, after which the
  /// robot is lost; 0: never
  explicit KidnapDetector(int lost_after) : lost_after_(lost_after) {}

  /// Adds the evidence of one scan.
  void update(const Evidence& evidence);

  /// Landmarks from this key on are provisional.
  int firstProvisional() const { return first_provisional_; }

  /// Establishes all landmarks below this key.
  void confirm(int next_key) { first_provisional_ = next_key; }

  bool isConsistent() const { return misses_ <= 0; }  ///< whether no scan suggests that the robot is lost

  /// Whether the robot is lost: one missing landmark is not enough, two or a contradiction are.
  bool isLost() const;

 private:
  void forget();
  void updateMisses(int observed, const std::vector<int>& missed, const Evidence& evidence);

  int lost_after_;
  double misses_ = 0;     // scans
  std::set<int> missed_;  // since misses_ was 0
  bool is_blank_ = true;  // whether nothing was observed since misses_ was 0
  bool contradicted_ = false;
  int first_provisional_ = 0;
  int confirmations_ = 0;  // successive scans with more established landmarks observed than missed
};

}  // namespace sextant
