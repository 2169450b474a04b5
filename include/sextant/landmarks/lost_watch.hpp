// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <vector>

namespace sextant {

/// Finds out that a robot is not where it thinks: nothing of what was there before is where it should be.
/// What it begins is loose, and tells nothing of that, until it has been seen together with what was there
/// before.
class LostWatch {
 public:
  /// What a look at the surroundings said.
  struct Look {
    std::vector<int> seen;    ///< keys of landmarks
    std::vector<int> missed;  ///< keys of those that surely should have been seen
    int strangers = 0;        ///< sightings that contradict the map
    int unknown = 0;          ///< sightings of what the map does not have
    int next_key = 0;         ///< of a landmark that will be begun
  };

  /// @param lost_after looks that say so, more than those that do not; 0: the robot is never lost
  explicit LostWatch(int lost_after) : lost_after_(lost_after) {}

  void look(const Look& look);

  /// Landmarks from this key on are loose.
  int firstLoose() const { return first_loose_; }

  /// Nothing is loose: landmarks below this key were there before.
  void join(int next_key) { first_loose_ = next_key; }

  bool isCalm() const { return misses_ == 0; }  ///< nothing says that the robot is lost

  /// One thing that is gone makes no robot lost, two do.
  bool isLost() const;

 private:
  void weigh(int seen, const std::vector<int>& missed, const Look& look);

  int lost_after_;
  int misses_ = 0;
  std::set<int> missed_;  // since it was calm
  bool strangers_ = false;
  int first_loose_ = 0;
  int bonds_ = 0;  // looks in a row at which more of what was there before was seen than missed
};

}  // namespace sextant
