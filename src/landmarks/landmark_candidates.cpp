// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_candidates.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {

ParamList CandidateParams::fields() {
  return {
      {"observations", &observations, Range::closed(0, 1000), "",
       "a candidate with more observations than this becomes a landmark; 0: at the first observation"},
      {"gate", &gate, Range::openHigh(0.5, 1), "",
       "probability of the gate within which an observation matches a candidate"},
      {"max_age", &max_age, Range::openLow(0, 3600), "s",
       "time after its last observation at which a candidate is removed"},
  };
}

/// Squared Mahalanobis distance between an observation and a candidate; infinite if their labels differ.
double LandmarkCandidates::distance(const Candidate& candidate,
                                    const PositionObservation& observation) const {
  if (!(candidate.mean.label == observation.label)) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d apart = observation.position - candidate.mean.position;
  // mean.covariance is that of one observation
  const Eigen::Matrix2d S = observation.covariance + candidate.mean.covariance / candidate.count;
  return apart.dot(S.llt().solve(apart));
}

std::optional<size_t> LandmarkCandidates::nearest(const PositionObservation& observation) const {
  std::optional<size_t> found;
  double least = -2 * std::log1p(-params_.gate);  // quantile of chi-squared with two degrees of freedom
  for (size_t k = 0; k < candidates_.size(); ++k) {
    const double apart = distance(candidates_[k], observation);
    if (apart < least) found = k, least = apart;
  }
  return found;
}

std::optional<double> LandmarkCandidates::logDensityOf(const PositionObservation& observation) const {
  std::optional<double> most;
  for (const Candidate& each : candidates_) {
    const Eigen::Matrix2d S = observation.covariance + each.mean.covariance / each.count;
    most = std::max(most, std::optional(logDensity(distance(each, observation), std::sqrt(S.determinant()))));
  }
  return most;
}

std::vector<bool> LandmarkCandidates::observe(double stamp,
                                              const std::vector<PositionObservation>& observations) {
  const auto is_too_old = [&](const Candidate& each) { return stamp - each.last > params_.max_age; };
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), is_too_old), candidates_.end());
  std::vector<std::optional<size_t>> nearest_observation(candidates_.size());
  for (size_t i = 0; i < observations.size(); ++i) {
    const auto k = nearest(observations[i]);
    if (k &&
        (!nearest_observation[*k] || distance(candidates_[*k], observations[i]) <
                                         distance(candidates_[*k], observations[*nearest_observation[*k]])))
      nearest_observation[*k] = i;
  }
  std::vector<std::optional<size_t>> candidate_of(observations.size());
  for (size_t k = 0; k < nearest_observation.size(); ++k)
    if (nearest_observation[k]) candidate_of[*nearest_observation[k]] = k;

  std::vector<bool> is_landmark(observations.size(), false);
  for (size_t i = 0; i < observations.size(); ++i) {
    if (!candidate_of[i]) {
      candidates_.push_back({observations[i], 1, stamp});
      is_landmark[i] = params_.observations < 1;
      continue;
    }
    Candidate& candidate = candidates_[*candidate_of[i]];
    const double weight = 1.0 / (1 + candidate.count);
    candidate.mean.position += weight * (observations[i].position - candidate.mean.position);
    candidate.mean.covariance += weight * (observations[i].covariance - candidate.mean.covariance);
    candidate.last = stamp;
    is_landmark[i] = ++candidate.count > params_.observations;
  }
  const auto is_done = [&](const Candidate& each) { return each.count > params_.observations; };
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), is_done), candidates_.end());
  return is_landmark;
}

}  // namespace sextant
