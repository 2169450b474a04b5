// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/pose_hypotheses.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

constexpr size_t kMaxRefined = 6;  // number of initial poses that are refined, those of the lowest cost
constexpr int kGateRounds = 4;     // maximum number of minimizations until the set of markers is stable
// Cost of an outlier. Larger than the default gate, so that two consistent markers win against a single one,
// whose large covariance raises its evidence.
constexpr double kOutlierCost = 100.0;
// Maximum squared Mahalanobis distance between two fits of the same minimum.
constexpr double kSameMinimum = 1e-3;
constexpr double kNotRobust = 1e9;  // width of the Huber loss, standard deviations

Matrix6d symmetricInverse(const Matrix6d& matrix) {
  const Matrix6d inverse = matrix.ldlt().solve(Matrix6d::Identity());
  return 0.5 * (inverse + inverse.transpose());
}

// Squared Mahalanobis distance.
double squaredDistance(const Pose& a, const Pose& b, const Matrix6d& covariance) {
  const Vector6d xi = poseError(a, b);
  return xi.dot(covariance.ldlt().solve(xi));
}

// Floor prior and Huber loss of all markers.
double robustCost(const std::vector<MarkerObservation>& observations, const Pose& pose,
                  const HypothesesParams& params) {
  double cost = params.floor ? squaredMahalanobis(*params.floor, pose) : 0.0;
  for (const MarkerObservation& observation : observations) {
    const double s = squaredMahalanobis(observation, pose), w = params.robust_width;
    cost += s <= w * w ? s : 2 * w * std::sqrt(std::min(s, 1e6)) - w * w;
  }
  return cost;
}

// The initial poses with the lowest robust cost.
std::vector<InitialPose> bestInitialPoses(const std::vector<MarkerObservation>& observations,
                                          const std::vector<InitialPose>& initial_poses,
                                          const HypothesesParams& params) {
  std::vector<std::pair<double, size_t>> scored;
  for (size_t i = 0; i < initial_poses.size(); ++i)
    scored.emplace_back(robustCost(observations, initial_poses[i].T_map_base, params), i);
  std::sort(scored.begin(), scored.end());
  if (scored.size() > kMaxRefined) scored.resize(kMaxRefined);
  std::vector<InitialPose> best;
  for (const auto& entry : scored) best.push_back(initial_poses[entry.second]);
  return best;
}

// Indices of the observations within the gate.
std::vector<size_t> withinGate(const std::vector<MarkerObservation>& observations, const Pose& pose,
                               double gate) {
  std::vector<size_t> used;
  for (size_t i = 0; i < observations.size(); ++i)
    if (squaredMahalanobis(observations[i], pose) <= gate) used.push_back(i);
  return used;
}

PoseHypothesis makeHypothesis(const ReprojectionFit& fit, const std::vector<size_t>& used,
                              double outlier_cost) {
  return {
      fit.T_map_base, symmetricInverse(fit.information), fit.cost + outlier_cost, fit.rms, used, 0.0, 0.0};
}

std::vector<MarkerObservation> selected(const std::vector<MarkerObservation>& observations,
                                        const std::vector<size_t>& indices) {
  std::vector<MarkerObservation> selection;
  for (const size_t i : indices) selection.push_back(observations[i]);
  return selection;
}

// Minimizes with the markers within the gate until the set of these markers is stable; nothing if it is not.
std::optional<PoseHypothesis> minimizeWithinGate(const std::vector<MarkerObservation>& observations,
                                                 const Pose& start, std::vector<size_t> used,
                                                 const HypothesesParams& params) {
  Pose pose = start;
  for (int round = 0; round < kGateRounds && !used.empty(); ++round) {
    const auto fit = minimizeReprojection(selected(observations, used), pose, {kNotRobust, params.floor});
    if (!fit) return std::nullopt;
    const auto fitting = withinGate(observations, fit->T_map_base, params.gate);
    if (fitting == used)
      return makeHypothesis(*fit, used,
                            kOutlierCost * static_cast<double>(observations.size() - used.size()));
    used = fitting;
    pose = fit->T_map_base;
  }
  return std::nullopt;
}

// Minimizes robustly with all markers, then with those within the gate.
std::optional<PoseHypothesis> fromAllMarkers(const std::vector<MarkerObservation>& observations,
                                             const InitialPose& initial, const HypothesesParams& params) {
  const auto fit =
      minimizeReprojection(observations, initial.T_map_base, {params.robust_width, params.floor});
  if (!fit) return std::nullopt;
  return minimizeWithinGate(observations, fit->T_map_base,
                            withinGate(observations, fit->T_map_base, params.gate), params);
}

// Increase of the cost if this marker is added to the fit: its squared Mahalanobis distance including the
// uncertainty of the pose, r' (I + J P J')^-1 r.
double costIncrease(const MarkerObservation& observation, const ReprojectionFit& fit) {
  const ReprojectionModel model = reprojectionModel({observation}, fit.T_map_base, {});
  return model.cost - model.g.dot((fit.information + model.H).ldlt().solve(model.g));
}

// The unused marker that is most consistent with the fit; nothing if all are outside the gate.
std::optional<size_t> mostConsistentUnused(const std::vector<MarkerObservation>& observations,
                                           const ReprojectionFit& fit, const std::vector<size_t>& used,
                                           double gate) {
  std::optional<size_t> best;
  double least = gate;
  for (size_t i = 0; i < observations.size(); ++i) {
    if (std::find(used.begin(), used.end(), i) != used.end()) continue;
    const double cost = costIncrease(observations[i], fit);
    if (!(cost <= least)) continue;
    least = cost;
    best = i;
  }
  return best;
}

// Starts with one marker and adds consistent ones: if markers contradict each other, a minimization with all
// of them ends between two poses.
std::optional<PoseHypothesis> fromOneMarker(const std::vector<MarkerObservation>& observations,
                                            const InitialPose& initial, const HypothesesParams& params) {
  Pose pose = initial.T_map_base;
  for (std::vector<size_t> used{initial.observation};;) {
    const auto fit = minimizeReprojection(selected(observations, used), pose, {kNotRobust, params.floor});
    if (!fit) return std::nullopt;
    const auto next = mostConsistentUnused(observations, *fit, used, params.gate);
    if (!next) return minimizeWithinGate(observations, fit->T_map_base, used, params);
    used.push_back(*next);
    std::sort(used.begin(), used.end());
    pose = fit->T_map_base;
  }
}

bool isExplained(size_t observation, const std::vector<PoseHypothesis>& hypotheses) {
  return std::any_of(hypotheses.begin(), hypotheses.end(), [&](const PoseHypothesis& hypothesis) {
    return std::find(hypothesis.used.begin(), hypothesis.used.end(), observation) != hypothesis.used.end();
  });
}

// Of two fits of the same minimum, keeps the one with the lower cost.
void addIfNew(const PoseHypothesis& hypothesis, std::vector<PoseHypothesis>& hypotheses) {
  for (PoseHypothesis& other : hypotheses) {
    if (squaredDistance(hypothesis.T_map_base, other.T_map_base, other.covariance) > kSameMinimum) continue;
    if (hypothesis.cost < other.cost) other = hypothesis;
    return;
  }
  hypotheses.push_back(hypothesis);
}

// Log density of the prior, convolved with the hypothesis's covariance, at the hypothesis's pose.
double logPrior(const PoseHypothesis& hypothesis, const PosePrior& prior) {
  const Matrix6d covariance = hypothesis.covariance + prior.covariance;
  return -0.5 * squaredDistance(hypothesis.T_map_base, prior.T_map_base, covariance) -
         0.5 * std::log(covariance.determinant());
}

// Logarithm of the probability mass of a minimum (Laplace's approximation), up to a constant.
double logEvidence(const PoseHypothesis& hypothesis) {
  return -0.5 * hypothesis.cost + 0.5 * std::log(hypothesis.covariance.determinant()) + hypothesis.log_prior;
}

// Computes the weights and sorts by them.
void computeWeights(std::vector<PoseHypothesis>& hypotheses, const std::optional<PosePrior>& prior) {
  double largest = -std::numeric_limits<double>::infinity(), sum = 0.0;
  for (PoseHypothesis& each : hypotheses) {
    if (prior) each.log_prior = logPrior(each, *prior);
    largest = std::max(largest, each.weight = logEvidence(each));
  }
  for (PoseHypothesis& each : hypotheses) sum += each.weight = std::exp(each.weight - largest);
  for (PoseHypothesis& each : hypotheses) each.weight /= sum;
  std::sort(hypotheses.begin(), hypotheses.end(),
            [](const auto& a, const auto& b) { return a.weight > b.weight; });
}

}  // namespace

std::vector<PoseHypothesis> poseHypotheses(const std::vector<MarkerObservation>& observations,
                                           const std::vector<InitialPose>& initial_poses,
                                           const HypothesesParams& params,
                                           const std::optional<PosePrior>& prior) {
  std::vector<PoseHypothesis> hypotheses;
  for (const InitialPose& initial : bestInitialPoses(observations, initial_poses, params)) {
    const auto from_all = fromAllMarkers(observations, initial, params);
    if (from_all) addIfNew(*from_all, hypotheses);
    if (from_all && from_all->used.size() == observations.size()) continue;
    if (const auto from_one = fromOneMarker(observations, initial, params)) addIfNew(*from_one, hypotheses);
  }
  // A marker that contradicts all others may be the right one.
  for (const InitialPose& initial : initial_poses) {
    if (isExplained(initial.observation, hypotheses)) continue;
    if (const auto alone =
            minimizeWithinGate(observations, initial.T_map_base, {initial.observation}, params))
      addIfNew(*alone, hypotheses);
  }
  computeWeights(hypotheses, prior);
  return hypotheses;
}

}  // namespace sextant
