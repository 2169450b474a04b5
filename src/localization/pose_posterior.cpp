// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/pose_posterior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "tilt_grid.hpp"

namespace sextant {
namespace {

constexpr double kRegion95 = 12.591587;  // 95 % of chi-square with 6 degrees of freedom
// Minimum probability within the 95 % region of an ambiguous pose. Regions with more are not changed, so that
// on average regions contain 95 %.
constexpr double kMinContained = 0.92;
constexpr double kAboutAsProbable = 0.5;  // minimum ratio of two groups' probabilities
constexpr double kNegligible = 1e-7;      // probability up to which a hypothesis is dropped
// A hypothesis is distinct if, about every axis, the ratio of its components' rotational second moment to the
// covariance at its minimum is between 1 / kMaxVarianceRatio and kMaxVarianceRatio.
constexpr double kMaxVarianceRatio = 2.25;
// Maximum squared Mahalanobis distance from 0 of the second-order term's mean, up to which Gaussians are
// used.
constexpr double kMaxNonlinearity = 0.01;

// A component of the Gaussian mixture.
struct Component {
  Pose T_map_base;
  Matrix6d covariance;
  double weight;
  size_t hypothesis;  // index of the minimum it belongs to
  size_t group;       // equal for hypotheses without a cost barrier between them
};

// Moments of the second-order term of p = c + Exp(r) (arm + s), which the covariance does not contain: r x s
// + r x (r x arm) / 2, with a Gaussian translation s and rotation r about the markers' centre c.
struct SecondOrder {
  Eigen::Vector3d mean;    // metres
  Eigen::Matrix3d moment;  // second moment about 0, m^2
};

// Matrices M of the second-order term: each coordinate is a quadratic form y' M y / 2 of y = (s, r).
std::array<Matrix6d, 3> secondOrderForms(const Eigen::Vector3d& arm) {
  std::array<Matrix6d, 3> forms;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(k);
    forms[k].setZero();
    forms[k].topRightCorner<3, 3>() = skew(axis);
    forms[k].bottomLeftCorner<3, 3>() = -skew(axis);
    forms[k].bottomRightCorner<3, 3>() = 0.5 * (axis * arm.transpose() + arm * axis.transpose());
    forms[k].bottomRightCorner<3, 3>().diagonal().array() -= arm[k];
  }
  return forms;
}

// Moments of quadratic forms of a Gaussian (Isserlis 1918).
SecondOrder secondOrder(const PoseHypothesis& hypothesis, const Pivot& pivot) {
  const Matrix6d inverse = pivot.jacobian(hypothesis.T_map_base).inverse();
  const Matrix6d covariance = inverse * hypothesis.covariance * inverse.transpose();
  auto forms = secondOrderForms(hypothesis.T_map_base.translation() - pivot.centre());
  SecondOrder result;
  for (int k = 0; k < 3; ++k) {
    forms[k] = forms[k] * covariance;
    result.mean[k] = 0.5 * forms[k].trace();
  }
  result.moment = result.mean * result.mean.transpose();
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) result.moment(k, l) += 0.5 * (forms[k] * forms[l]).trace();
  return result;
}

// Squared Mahalanobis distance of the second-order term's mean from 0.
double nonlinearity(const PoseHypothesis& hypothesis, const SecondOrder& term) {
  Vector6d mean = Vector6d::Zero();
  mean.head<3>() = term.mean;
  return mean.dot(hypothesis.covariance.ldlt().solve(mean));
}

// Whether the cost rises as the covariance predicts, 2.5 standard deviations to either side along the two
// least certain rotations. If a marker is seen nearly head-on it does not, because two minima merge there.
bool isQuadratic(const std::vector<MarkerObservation>& used, const PoseHypothesis& hypothesis,
                 const std::optional<FloorPrior>& floor) {
  constexpr double kDeviations = 2.5, kTolerance = 0.25;
  const Pivot pivot(used);
  const ReprojectionParams params{1e9, floor};
  const Matrix6d inverse = pivot.jacobian(hypothesis.T_map_base).inverse();
  const Matrix6d covariance = inverse * hypothesis.covariance * inverse.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> rotation(covariance.bottomRightCorner<3, 3>());
  const double least = reprojectionModel(used, hypothesis.T_map_base, params).cost;
  for (const int axis : {2, 1}) {
    Vector6d direction = Vector6d::Zero();
    direction.tail<3>() = rotation.eigenvectors().col(axis);
    const Vector6d step = kDeviations * covariance * direction / std::sqrt(rotation.eigenvalues()[axis]);
    for (const double sign : {1.0, -1.0}) {
      const double cost =
          reprojectionModel(used, pivot.moved(hypothesis.T_map_base, sign * step), params).cost;
      if (!(std::abs(cost - least - kDeviations * kDeviations) < kTolerance * kDeviations * kDeviations))
        return false;
    }
  }
  return true;
}

std::vector<MarkerObservation> observationsUsed(const PoseHypothesis& hypothesis,
                                                const std::vector<MarkerObservation>& observations) {
  std::vector<MarkerObservation> used;
  for (const size_t i : hypothesis.used) used.push_back(observations[i]);
  return used;
}

// One Gaussian per hypothesis, with the covariance of its minimum plus the moment of the second-order term.
std::vector<Component> gaussianMixture(const std::vector<MarkerObservation>& observations,
                                       const std::vector<PoseHypothesis>& hypotheses) {
  std::vector<Component> mixture;
  for (size_t i = 0; i < hypotheses.size(); ++i) {
    if (hypotheses[i].weight <= kNegligible) continue;
    Matrix6d covariance = hypotheses[i].covariance;
    covariance.topLeftCorner<3, 3>() +=
        secondOrder(hypotheses[i], Pivot(observationsUsed(hypotheses[i], observations))).moment;
    mixture.push_back({hypotheses[i].T_map_base, covariance, hypotheses[i].weight, i, i});
  }
  return mixture;
}

// Indices of the hypotheses with the same markers as the best one.
std::vector<size_t> withSameMarkers(const std::vector<PoseHypothesis>& hypotheses) {
  std::vector<size_t> same;
  for (size_t i = 0; i < hypotheses.size(); ++i)
    if (hypotheses[i].used == hypotheses[0].used) same.push_back(i);
  return same;
}

// Replaces the Gaussians of the hypotheses `same` by the cells of the grid, with the same total weight.
// The prior only weights groups of minima: within a group it would change the pose.
std::vector<Component> withGrid(const std::vector<Component>& gaussians,
                                const std::vector<PoseHypothesis>& hypotheses,
                                const std::vector<size_t>& same, const TiltGrid& grid) {
  std::map<size_t, double> log_prior;
  for (size_t k = 0; k < same.size(); ++k) {
    const auto entry = log_prior.insert({grid.group[k], hypotheses[same[k]].log_prior}).first;
    entry->second = std::max(entry->second, hypotheses[same[k]].log_prior);
  }
  const auto log_weight = [&](const TiltCell& cell) {
    return cell.log_density + log_prior.at(grid.group[cell.hypothesis]);
  };
  double total = 0.0, sum = 0.0, largest = -std::numeric_limits<double>::infinity();
  for (const size_t i : same) total += hypotheses[i].weight;
  for (const TiltCell& cell : grid.cells) largest = std::max(largest, log_weight(cell));
  for (const TiltCell& cell : grid.cells) sum += std::exp(log_weight(cell) - largest);
  std::vector<Component> mixture;
  for (const TiltCell& cell : grid.cells)
    mixture.push_back({cell.T_map_base, cell.covariance, total * std::exp(log_weight(cell) - largest) / sum,
                       same[cell.hypothesis], same[grid.group[cell.hypothesis]]});
  for (const Component& other : gaussians)
    if (std::find(same.begin(), same.end(), other.hypothesis) == same.end()) mixture.push_back(other);
  return mixture;
}

// The posterior as a Gaussian mixture: one component per hypothesis or, where a Gaussian is a poor
// approximation, the cells of a tilt grid.
std::vector<Component> posteriorMixture(const std::vector<MarkerObservation>& observations,
                                        const std::vector<PoseHypothesis>& hypotheses,
                                        const PosteriorParams& params) {
  const auto gaussians = gaussianMixture(observations, hypotheses);
  const auto used = observationsUsed(hypotheses[0], observations);
  if (nonlinearity(hypotheses[0], secondOrder(hypotheses[0], Pivot(used))) < kMaxNonlinearity &&
      isQuadratic(used, hypotheses[0], params.floor))
    return gaussians;
  const auto same = withSameMarkers(hypotheses);
  std::vector<PoseHypothesis> minima;
  for (const size_t i : same) minima.push_back(hypotheses[i]);
  const TiltGrid grid = tiltGrid(used, minima, params.floor);
  return grid.cells.empty() ? gaussians : withGrid(gaussians, hypotheses, same, grid);
}

// Second moment of a mixture about a pose.
Matrix6d secondMoment(const std::vector<Component>& mixture, const Pose& about) {
  Matrix6d moment = Matrix6d::Zero();
  double sum = 0.0;
  for (const Component& component : mixture) {
    const Vector6d e = poseError(component.T_map_base, about);
    moment += component.weight * (component.covariance + e * e.transpose());
    sum += component.weight;
  }
  return moment / sum;
}

// Probability that a sum of squares with this mean and variance is below x: Wilson and Hilferty's cube root
// approximation of the chi-square distribution with these moments (Patnaik 1949).
double probabilityBelow(double x, double mean, double variance) {
  const double v = variance / (9 * mean * mean);  // 2 / (9 degrees of freedom)
  return 0.5 * std::erfc(-(std::cbrt(x / mean) - (1 - v)) / std::sqrt(2 * v));
}

// Factor on a covariance with which its 95 % region about a pose contains kMinContained of a mixture.
double regionScale(const std::vector<Component>& mixture, const Pose& about, const Matrix6d& covariance) {
  struct SquaredDistance {  // of a component's poses
    double weight, mean, variance;
  };
  const Eigen::LLT<Matrix6d> cholesky(covariance);
  std::vector<SquaredDistance> squares;
  for (const Component& component : mixture) {
    const Vector6d m = cholesky.matrixL().solve(poseError(component.T_map_base, about));
    const Matrix6d half = cholesky.matrixL().solve(component.covariance);
    const Matrix6d S = cholesky.matrixL().solve(half.transpose());
    squares.push_back(
        {component.weight, m.squaredNorm() + S.trace(), 2 * S.squaredNorm() + 4 * m.dot(S * m)});
  }
  double low = 0.05, high = 20.0;
  for (int i = 0; i < 20; ++i) {  // bisection of the factor's logarithm
    const double middle = std::sqrt(low * high);
    double contained = 0.0, sum = 0.0;
    for (const SquaredDistance& s : squares) {
      contained += s.weight * probabilityBelow(middle * kRegion95, s.mean, s.variance);
      sum += s.weight;
    }
    (contained < kMinContained * sum ? low : high) = middle;
  }
  return high;
}

// Probability of each group or hypothesis. @param key &Component::group or &Component::hypothesis
std::map<size_t, double> probabilities(const std::vector<Component>& mixture, size_t Component::*key) {
  std::map<size_t, double> result;
  double sum = 0.0;
  for (const Component& component : mixture) sum += component.weight;
  for (const Component& component : mixture) result[component.*key] += component.weight / sum;
  return result;
}

// Whether the second moment of a hypothesis' components agrees with the covariance at its minimum. Where two
// minima merge (a marker is seen nearly head-on), the valley of the cost is flat or asymmetric, and the two
// poses cannot be distinguished.
bool isDistinct(const std::vector<Component>& mixture, size_t hypothesis, const PoseHypothesis& minimum) {
  std::vector<Component> own;
  std::copy_if(mixture.begin(), mixture.end(), std::back_inserter(own),
               [&](const Component& component) { return component.hypothesis == hypothesis; });
  const Matrix6d moment = secondMoment(own, minimum.T_map_base);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> ratio(
      moment.bottomRightCorner<3, 3>(), minimum.covariance.bottomRightCorner<3, 3>(), Eigen::EigenvaluesOnly);
  return ratio.eigenvalues()[0] * kMaxVarianceRatio > 1 && ratio.eigenvalues()[2] < kMaxVarianceRatio;
}

// The key with the largest value.
size_t largest(const std::map<size_t, double>& values) {
  return std::max_element(values.begin(), values.end(), [](auto& a, auto& b) { return a.second < b.second; })
      ->first;
}

// Of the groups that are about as probable as the most probable one, that with the pose that fits best.
size_t bestGroup(const std::map<size_t, double>& probabilities, const std::vector<Component>& mixture,
                 const std::vector<PoseHypothesis>& hypotheses) {
  std::map<size_t, double> fits;  // by group: largest log density of a pose
  const double most = probabilities.at(largest(probabilities));
  for (const Component& component : mixture) {
    if (probabilities.at(component.group) < kAboutAsProbable * most) continue;
    const PoseHypothesis& hypothesis = hypotheses[component.hypothesis];
    const double fit = hypothesis.log_prior - 0.5 * hypothesis.cost;
    const auto entry = fits.insert({component.group, fit}).first;
    entry->second = std::max(entry->second, fit);
  }
  return largest(fits);
}

// The most probable hypothesis of a group, weighted with the prior.
size_t bestHypothesis(const std::vector<Component>& group, const std::vector<PoseHypothesis>& hypotheses) {
  auto weights = probabilities(group, &Component::hypothesis);
  for (auto& [hypothesis, weight] : weights) weight = std::log(weight) + hypotheses[hypothesis].log_prior;
  return largest(weights);
}

}  // namespace

PosePosterior posePosterior(const std::vector<MarkerObservation>& observations,
                            const std::vector<PoseHypothesis>& hypotheses, const PosteriorParams& params) {
  auto mixture = posteriorMixture(observations, hypotheses, params);
  const auto of_groups = probabilities(mixture, &Component::group);
  const size_t group = bestGroup(of_groups, mixture, hypotheses);
  std::vector<Component> best_group;
  std::copy_if(mixture.begin(), mixture.end(), std::back_inserter(best_group),
               [&](const Component& component) { return component.group == group; });
  if (of_groups.at(group) >= params.min_probability) mixture = best_group;
  PosePosterior posterior;
  posterior.best = bestHypothesis(best_group, hypotheses);
  posterior.probability = probabilities(mixture, &Component::hypothesis).at(posterior.best);
  if (!isDistinct(mixture, posterior.best, hypotheses[posterior.best]))
    posterior.probability = std::min(posterior.probability, 0.5);
  const Pose& about = hypotheses[posterior.best].T_map_base;
  posterior.covariance = secondMoment(mixture, about);
  if (posterior.probability < params.min_probability)
    posterior.covariance *= std::max(1.0, regionScale(mixture, about, posterior.covariance));
  return posterior;
}

}  // namespace sextant
