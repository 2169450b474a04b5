// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "sextant/landmarks/landmark_timeline.hpp"

namespace sextant {

/// Compares the sources of a pose with it: printed markers, other landmarks, and places. Names those that
/// support it, and those that contradict it while another one supports it.
class SourceMonitor {
 public:
  /// Adds a scan or an image that was applied.
  void add(const LandmarkTimeline::Applied& applied);
  /// Adds an image with too little content to recognize a place. @param stamp seconds
  void addUnusable(double stamp) { note(PoseSource::places, stamp, Verdict::misses); }

  /// Names of the sources that support the pose, with their numbers of scans and images, e.g. "markers (25)";
  /// "none" if only odometry does.
  std::string supporting() const;

  /// A sentence on each source that contradicts the pose, or whose sensor seems to have failed, and what to
  /// do.
  std::vector<std::string> problems() const;

 private:
  enum class Verdict { supports, contradicts, misses };
  struct Event {
    double stamp;
    Verdict verdict;
  };
  using Source = std::deque<Event>;  // by arrival, without those that show nothing
  size_t count(const Source& source, Verdict verdict) const;
  bool isContradicting(size_t source) const;
  void addScan(const LandmarkTimeline::Applied& applied);
  void note(PoseSource source, double stamp, Verdict verdict);

  std::map<PoseSource, double> wrong_since_;  // stamp, of those that the best hypothesis takes to be wrong
  double newest_ = 0;                         // stamp
  std::array<Source, kPoseSources> sources_;  // in the order of PoseSource
};

}  // namespace sextant
