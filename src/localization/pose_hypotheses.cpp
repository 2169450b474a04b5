// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/pose_hypotheses.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

constexpr size_t kMaxRefined = 6;  // starts, the best by robust cost
constexpr int kGateRounds = 4;
// What a marker costs that is left out. More than the gate: two that agree are to win against one that leaves
// much open, whose covariance speaks for it.
constexpr double kLeftOut = 100.0;
constexpr double kSameDistance = 1e-3;  // squared Mahalanobis distance of two fits that are one minimum

Matrix6d symmetricInverse(const Matrix6d& matrix) {
  const Matrix6d inverse = matrix.ldlt().solve(Matrix6d::Identity());
  return 0.5 * (inverse + inverse.transpose());
}

double squaredDistance(const Pose& a, const Pose& b, const Matrix6d& covariance) {
  const Vector6d xi = poseError(a, b);
  return xi.dot(covariance.ldlt().solve(xi));
}

double robustCost(const std::vector<MarkerSighting>& sightings, const Pose& pose,
                  const HypothesesParams& params) {
  double cost = params.floor ? squaredMahalanobis(*params.floor, pose) : 0.0;
  for (const MarkerSighting& sighting : sightings) {
    const double s = squaredMahalanobis(sighting, pose), w = params.robust_width;
    cost += s <= w * w ? s : 2 * w * std::sqrt(std::min(s, 1e6)) - w * w;
  }
  return cost;
}

std::vector<PoseStart> bestStarts(const std::vector<MarkerSighting>& sightings,
                                  const std::vector<PoseStart>& starts, const HypothesesParams& params) {
  std::vector<std::pair<double, size_t>> scored;
  for (size_t i = 0; i < starts.size(); ++i)
    scored.emplace_back(robustCost(sightings, starts[i].T_map_base, params), i);
  std::sort(scored.begin(), scored.end());
  if (scored.size() > kMaxRefined) scored.resize(kMaxRefined);
  std::vector<PoseStart> best;
  for (const auto& entry : scored) best.push_back(starts[entry.second]);
  return best;
}

std::vector<size_t> withinGate(const std::vector<MarkerSighting>& sightings, const Pose& pose, double gate) {
  std::vector<size_t> used;
  for (size_t i = 0; i < sightings.size(); ++i)
    if (squaredMahalanobis(sightings[i], pose) <= gate) used.push_back(i);
  return used;
}

PoseHypothesis hypothesis(const ReprojectionFit& fit, const std::vector<size_t>& used, double left_out_cost) {
  return {
      fit.T_map_base, symmetricInverse(fit.information), fit.cost + left_out_cost, fit.rms, used, 0.0, 0.0};
}

std::vector<MarkerSighting> chosen(const std::vector<MarkerSighting>& sightings,
                                   const std::vector<size_t>& indices) {
  std::vector<MarkerSighting> some;
  for (const size_t i : indices) some.push_back(sightings[i]);
  return some;
}

// Plain searches with the markers inside the gate, until these stay the same.
std::optional<PoseHypothesis> settled(const std::vector<MarkerSighting>& sightings, const Pose& start,
                                      std::vector<size_t> used, const HypothesesParams& params) {
  Pose pose = start;
  for (int round = 0; round < kGateRounds && !used.empty(); ++round) {
    const auto fit = minimizeReprojection(chosen(sightings, used), pose, {1e9, params.floor});
    if (!fit) return std::nullopt;
    const auto now = withinGate(sightings, fit->T_map_base, params.gate);
    if (now == used)
      return hypothesis(*fit, used, kLeftOut * static_cast<double>(sightings.size() - used.size()));
    used = now;
    pose = fit->T_map_base;
  }
  return std::nullopt;
}

// The minimum to which a robust search with all markers leads.
std::optional<PoseHypothesis> together(const std::vector<MarkerSighting>& sightings, const PoseStart& start,
                                       const HypothesesParams& params) {
  const auto fit = minimizeReprojection(sightings, start.T_map_base, {params.robust_width, params.floor});
  if (!fit) return std::nullopt;
  return settled(sightings, fit->T_map_base, withinGate(sightings, fit->T_map_base, params.gate), params);
}

// By how much the cost would rise if the pose had to explain this marker too: its squared Mahalanobis
// distance with the pose's own uncertainty added, r' (I + J P J')^-1 r.
double rise(const MarkerSighting& sighting, const ReprojectionFit& fit) {
  const ReprojectionModel model = reprojectionModel({sighting}, fit.T_map_base, {});
  return model.cost - model.g.dot((fit.information + model.H).ldlt().solve(model.g));
}

// The marker, outside of those used, that agrees best with the fit.
std::optional<size_t> nextToAgree(const std::vector<MarkerSighting>& sightings, const ReprojectionFit& fit,
                                  const std::vector<size_t>& used, double gate) {
  std::optional<size_t> best;
  for (size_t i = 0; i < sightings.size(); ++i) {
    if (std::find(used.begin(), used.end(), i) != used.end()) continue;
    const double cost = rise(sightings[i], fit);
    if (!(cost <= gate)) continue;
    gate = cost;
    best = i;
  }
  return best;
}

// One marker, and one after another those that agree with all before: where markers contradict each other, a
// search with all of them ends between two poses.
std::optional<PoseHypothesis> grown(const std::vector<MarkerSighting>& sightings, const PoseStart& start,
                                    const HypothesesParams& params) {
  Pose pose = start.T_map_base;
  for (std::vector<size_t> used{start.sighting};;) {
    const auto fit = minimizeReprojection(chosen(sightings, used), pose, {1e9, params.floor});
    if (!fit) return std::nullopt;
    const auto next = nextToAgree(sightings, *fit, used, params.gate);
    if (!next) return settled(sightings, fit->T_map_base, used, params);
    used.push_back(*next);
    std::sort(used.begin(), used.end());
    pose = fit->T_map_base;
  }
}

bool explained(size_t sighting, const std::vector<PoseHypothesis>& all) {
  return std::any_of(all.begin(), all.end(), [&](const PoseHypothesis& found) {
    return std::find(found.used.begin(), found.used.end(), sighting) != found.used.end();
  });
}

void addIfNew(const PoseHypothesis& found, std::vector<PoseHypothesis>& all) {
  for (PoseHypothesis& other : all) {
    if (squaredDistance(found.T_map_base, other.T_map_base, other.covariance) > kSameDistance) continue;
    if (found.cost < other.cost) other = found;
    return;
  }
  all.push_back(found);
}

// Logarithm of the density at which the prior, blurred by the hypothesis's own covariance, has its pose.
double logPrior(const PoseHypothesis& found, const PosePrior& prior) {
  const Matrix6d both = found.covariance + prior.covariance;
  return -0.5 * squaredDistance(found.T_map_base, prior.T_map_base, both) -
         0.5 * std::log(both.determinant());
}

// Laplace's approximation of the probability that a minimum holds, up to a factor; its logarithm.
double logEvidence(const PoseHypothesis& found) {
  return -0.5 * found.cost + 0.5 * std::log(found.covariance.determinant()) + found.log_prior;
}

void weigh(std::vector<PoseHypothesis>& all, const std::optional<PosePrior>& prior) {
  double largest = -std::numeric_limits<double>::infinity(), sum = 0.0;
  for (PoseHypothesis& found : all) {
    if (prior) found.log_prior = logPrior(found, *prior);
    largest = std::max(largest, found.weight = logEvidence(found));
  }
  for (PoseHypothesis& found : all) sum += found.weight = std::exp(found.weight - largest);
  for (PoseHypothesis& found : all) found.weight /= sum;
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
}

}  // namespace

std::vector<PoseHypothesis> poseHypotheses(const std::vector<MarkerSighting>& sightings,
                                           const std::vector<PoseStart>& starts,
                                           const HypothesesParams& params,
                                           const std::optional<PosePrior>& prior) {
  std::vector<PoseHypothesis> all;
  for (const PoseStart& start : bestStarts(sightings, starts, params)) {
    const auto found = together(sightings, start, params);
    if (found) addIfNew(*found, all);
    if (found && found->used.size() == sightings.size()) continue;
    if (const auto other = grown(sightings, start, params)) addIfNew(*other, all);
  }
  // Markers that contradict the others may be the ones that are right.
  for (const PoseStart& start : starts) {
    if (explained(start.sighting, all)) continue;
    if (const auto found = settled(sightings, start.T_map_base, {start.sighting}, params))
      addIfNew(*found, all);
  }
  weigh(all, prior);
  return all;
}

}  // namespace sextant
