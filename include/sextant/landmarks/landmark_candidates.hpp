// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// When something that is seen is taken for a landmark.
struct CandidateParams {
  double gate = 0.999;
  int sightings = 3;
  double memory = 10.0;

  ParamList fields();
};

/// Sightings of what may be landmarks: each is the mean of what was seen of it.
class LandmarkCandidates {
 public:
  explicit LandmarkCandidates(const CandidateParams& params) : params_(params) {}

  /// Whether each of the sightings of one moment is of something that is a landmark now; no candidate any
  /// more then. Sightings and candidates are matched where each is the other's nearest.
  /// @param stamp seconds @param sightings in the map frame
  std::vector<bool> see(double stamp, const std::vector<LandmarkPointSighting>& sightings);

  size_t size() const { return candidates_.size(); }
  void clear() { candidates_.clear(); }

 private:
  struct Candidate {
    LandmarkPointSighting mean;  // and the covariance of one sighting
    int count;
    double last;  // seconds
  };
  std::optional<size_t> nearest(const LandmarkPointSighting& sighting) const;
  double distance(const Candidate& candidate, const LandmarkPointSighting& sighting) const;

  CandidateParams params_;
  std::vector<Candidate> candidates_;
};

}  // namespace sextant
