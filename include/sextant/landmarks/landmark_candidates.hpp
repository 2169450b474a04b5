// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

/// Conditions under which repeated observations become a landmark.
struct CandidateParams {
  double gate = 0.999;
  int observations = 3;
  double max_age = 10.0;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// Landmark candidates: the running mean of the observations of each.
class LandmarkCandidates {
 public:
  /// No candidates.
  explicit LandmarkCandidates(const CandidateParams& params) : params_(params) {}

  /// Adds the observations of one scan. Observations and candidates are matched as mutual nearest neighbours.
  /// A candidate with enough observations becomes a landmark and is removed.
  /// @param stamp seconds @param observations in the map frame
  /// @returns for each observation whether it initializes a landmark
  std::vector<bool> observe(double stamp, const std::vector<PositionObservation>& observations);

  /// Logarithm of the density of an observation (map frame) if it is of a candidate, 1/m^2; nothing: there
  /// are no candidates.
  std::optional<double> logDensityOf(const PositionObservation& observation) const;

  size_t size() const { return candidates_.size(); }  ///< number of candidates
  void clear() { candidates_.clear(); }               ///< removes all candidates

 private:
  struct Candidate {
    PositionObservation mean;  // with the mean covariance of one observation
    int count;                 // observations
    double last;               // stamp in seconds
  };
  std::optional<size_t> nearest(const PositionObservation& observation) const;
  double distance(const Candidate& candidate, const PositionObservation& observation) const;

  CandidateParams params_;
  std::vector<Candidate> candidates_;
};

}  // namespace sextant
