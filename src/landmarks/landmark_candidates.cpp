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
      {"sightings", &sightings, Range::closed(0, 1000), "",
       "more sightings than these make a candidate a landmark; 0: no sighting is false"},
      {"gate", &gate, Range::openHigh(0.5, 1), "",
       "probability within which two sightings are of one candidate"},
      {"memory", &memory, Range::openLow(0, 3600), "s",
       "how long after its last sighting a candidate is forgotten"},
  };
}

/// Squared Mahalanobis distance of a sighting and the mean of others; of another label: infinite.
double LandmarkCandidates::distance(const Candidate& candidate, const LandmarkPointSighting& sighting) const {
  if (!(candidate.mean.label == sighting.label)) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d apart = sighting.position - candidate.mean.position;
  const Eigen::Matrix2d S = sighting.covariance + candidate.mean.covariance / candidate.count;
  return apart.dot(S.llt().solve(apart));
}

std::optional<size_t> LandmarkCandidates::nearest(const LandmarkPointSighting& sighting) const {
  std::optional<size_t> found;
  double least = -2 * std::log1p(-params_.gate);  // of chi-squared with two degrees of freedom
  for (size_t k = 0; k < candidates_.size(); ++k) {
    const double apart = distance(candidates_[k], sighting);
    if (apart < least) found = k, least = apart;
  }
  return found;
}

std::vector<bool> LandmarkCandidates::see(double stamp, const std::vector<LandmarkPointSighting>& sightings) {
  const auto is_forgotten = [&](const Candidate& each) { return stamp - each.last > params_.memory; };
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), is_forgotten), candidates_.end());
  std::vector<std::optional<size_t>> seen(candidates_.size());  // the sighting of each
  for (size_t i = 0; i < sightings.size(); ++i) {
    const auto k = nearest(sightings[i]);
    if (k && (!seen[*k] ||
              distance(candidates_[*k], sightings[i]) < distance(candidates_[*k], sightings[*seen[*k]])))
      seen[*k] = i;
  }
  std::vector<std::optional<size_t>> of(sightings.size());
  for (size_t k = 0; k < seen.size(); ++k)
    if (seen[k]) of[*seen[k]] = k;

  std::vector<bool> is_landmark(sightings.size(), false);
  for (size_t i = 0; i < sightings.size(); ++i) {
    if (!of[i]) {
      candidates_.push_back({sightings[i], 1, stamp});
      is_landmark[i] = params_.sightings < 1;
      continue;
    }
    Candidate& candidate = candidates_[*of[i]];
    const double weight = 1.0 / (1 + candidate.count);
    candidate.mean.position += weight * (sightings[i].position - candidate.mean.position);
    candidate.mean.covariance += weight * (sightings[i].covariance - candidate.mean.covariance);
    candidate.last = stamp;
    is_landmark[i] = ++candidate.count > params_.sightings;
  }
  const auto is_done = [&](const Candidate& each) { return each.count > params_.sightings; };
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), is_done), candidates_.end());
  return is_landmark;
}

}  // namespace sextant
