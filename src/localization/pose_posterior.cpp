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

#include "tilt_lattice.hpp"

namespace sextant {
namespace {

constexpr double kRegion95 = 12.591587;  // chi-square, 6 degrees of freedom
// Least probability that the region holds where undecided. A region that holds more stays as it is, so that
// all regions together hold 95 %.
constexpr double kHeld = 0.92;
constexpr double kNegligible = 1e-7;   // probability of a hypothesis that is not looked at
constexpr double kLikeMinimum = 2.25;  // variance of a rotation over what the minimum says, or inverse
constexpr double kCurved = 0.01;       // squared deviations by which the arc may leave its tangent

// A Gaussian about a pose, one of many that make up the distribution.
struct Component {
  Pose T_map_base;
  Matrix6d covariance;
  double weight;
  size_t hypothesis;  // to whose minimum it belongs
  size_t group;       // the same for hypotheses that no barrier parts
};

// The second order of p = c + Exp(r) (arm + s), which the covariance leaves out: r x s + r x (r x arm) / 2,
// with shift and turn about the markers' centre c Gaussian.
struct Bend {
  Eigen::Vector3d mean;
  Eigen::Matrix3d moment;  // second, about 0
};

// Each coordinate is a quadratic form y' M y / 2 of y = (s, r).
std::array<Matrix6d, 3> bendForms(const Eigen::Vector3d& arm) {
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
Bend bend(const PoseHypothesis& found, const Pivot& pivot) {
  const Matrix6d inverse = pivot.jacobian(found.T_map_base).inverse();
  const Matrix6d covariance = inverse * found.covariance * inverse.transpose();
  auto forms = bendForms(found.T_map_base.translation() - pivot.centre());
  Bend result;
  for (int k = 0; k < 3; ++k) {
    forms[k] = forms[k] * covariance;
    result.mean[k] = 0.5 * forms[k].trace();
  }
  result.moment = result.mean * result.mean.transpose();
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) result.moment(k, l) += 0.5 * (forms[k] * forms[l]).trace();
  return result;
}

// How far the bend's mean lies from the tangent, in squared deviations.
double curvature(const PoseHypothesis& found, const Bend& bend) {
  Vector6d mean = Vector6d::Zero();
  mean.head<3>() = bend.mean;
  return mean.dot(found.covariance.ldlt().solve(mean));
}

// Whether the cost rises as the covariance says along the two weakest rotations, 2.5 deviations to either
// side: nearly head-on it does not, where two minima meet in one.
bool rises(const std::vector<MarkerSighting>& used, const PoseHypothesis& found,
           const std::optional<FloorPrior>& floor) {
  constexpr double kDeviations = 2.5, kTolerance = 0.25;
  const Pivot pivot(used);
  const ReprojectionParams params{1e9, floor};
  const Matrix6d inverse = pivot.jacobian(found.T_map_base).inverse();
  const Matrix6d covariance = inverse * found.covariance * inverse.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> rotation(covariance.bottomRightCorner<3, 3>());
  const double least = reprojectionModel(used, found.T_map_base, params).cost;
  for (const int axis : {2, 1}) {
    Vector6d direction = Vector6d::Zero();
    direction.tail<3>() = rotation.eigenvectors().col(axis);
    const Vector6d step = kDeviations * covariance * direction / std::sqrt(rotation.eigenvalues()[axis]);
    for (const double sign : {1.0, -1.0}) {
      const double cost = reprojectionModel(used, pivot.moved(found.T_map_base, sign * step), params).cost;
      if (!(std::abs(cost - least - kDeviations * kDeviations) < kTolerance * kDeviations * kDeviations))
        return false;
    }
  }
  return true;
}

std::vector<MarkerSighting> usedBy(const PoseHypothesis& found,
                                   const std::vector<MarkerSighting>& sightings) {
  std::vector<MarkerSighting> used;
  for (const size_t i : found.used) used.push_back(sightings[i]);
  return used;
}

// The hypotheses as Gaussians, as the minima are, wider by their bend.
std::vector<Component> gaussians(const std::vector<MarkerSighting>& sightings,
                                 const std::vector<PoseHypothesis>& hypotheses) {
  std::vector<Component> all;
  for (size_t i = 0; i < hypotheses.size(); ++i) {
    if (hypotheses[i].weight <= kNegligible) continue;
    Matrix6d covariance = hypotheses[i].covariance;
    covariance.topLeftCorner<3, 3>() += bend(hypotheses[i], Pivot(usedBy(hypotheses[i], sightings))).moment;
    all.push_back({hypotheses[i].T_map_base, covariance, hypotheses[i].weight, i, i});
  }
  return all;
}

// Those that explain the same markers as the best one.
std::vector<size_t> peers(const std::vector<PoseHypothesis>& hypotheses) {
  std::vector<size_t> same;
  for (size_t i = 0; i < hypotheses.size(); ++i)
    if (hypotheses[i].used == hypotheses[0].used) same.push_back(i);
  return same;
}

// The lattice's cells instead of the Gaussians of the peers, with their share. The prior weighs groups:
// inside one it would not decide, it would be mixed in.
std::vector<Component> refined(const std::vector<Component>& gaussians,
                               const std::vector<PoseHypothesis>& hypotheses, const std::vector<size_t>& same,
                               const TiltLattice& lattice) {
  std::map<size_t, double> log_prior;
  for (size_t k = 0; k < same.size(); ++k) {
    const auto entry = log_prior.insert({lattice.group[k], hypotheses[same[k]].log_prior}).first;
    entry->second = std::max(entry->second, hypotheses[same[k]].log_prior);
  }
  const auto logarithm = [&](const TiltCell& cell) {
    return cell.log_density + log_prior.at(lattice.group[cell.hypothesis]);
  };
  double share = 0.0, sum = 0.0, largest = -std::numeric_limits<double>::infinity();
  for (const size_t i : same) share += hypotheses[i].weight;
  for (const TiltCell& cell : lattice.cells) largest = std::max(largest, logarithm(cell));
  for (const TiltCell& cell : lattice.cells) sum += std::exp(logarithm(cell) - largest);
  std::vector<Component> all;
  for (const TiltCell& cell : lattice.cells)
    all.push_back({cell.T_map_base, cell.covariance, share * std::exp(logarithm(cell) - largest) / sum,
                   same[cell.hypothesis], same[lattice.group[cell.hypothesis]]});
  for (const Component& other : gaussians)
    if (std::find(same.begin(), same.end(), other.hypothesis) == same.end()) all.push_back(other);
  return all;
}

std::vector<Component> components(const std::vector<MarkerSighting>& sightings,
                                  const std::vector<PoseHypothesis>& hypotheses,
                                  const PosteriorParams& params) {
  const auto simple = gaussians(sightings, hypotheses);
  const auto used = usedBy(hypotheses[0], sightings);
  if (curvature(hypotheses[0], bend(hypotheses[0], Pivot(used))) < kCurved &&
      rises(used, hypotheses[0], params.floor))
    return simple;
  const auto same = peers(hypotheses);
  std::vector<PoseHypothesis> minima;
  for (const size_t i : same) minima.push_back(hypotheses[i]);
  const TiltLattice lattice = tiltLattice(used, minima, params.floor);
  return lattice.cells.empty() ? simple : refined(simple, hypotheses, same, lattice);
}

// Second moment of the components about a pose.
Matrix6d secondMoment(const std::vector<Component>& all, const Pose& about) {
  Matrix6d moment = Matrix6d::Zero();
  double sum = 0.0;
  for (const Component& component : all) {
    const Vector6d e = poseError(component.T_map_base, about);
    moment += component.weight * (component.covariance + e * e.transpose());
    sum += component.weight;
  }
  return moment / sum;
}

// Probability that a sum of squares with this mean and variance is below x: Wilson and Hilferty's cube root
// of the chi-square distribution that has them (Patnaik 1949).
double probabilityBelow(double x, double mean, double variance) {
  const double v = variance / (9 * mean * mean);  // 2 / (9 degrees of freedom)
  return 0.5 * std::erfc(-(std::cbrt(x / mean) - (1 - v)) / std::sqrt(2 * v));
}

// The factor on a covariance with which its 95 % region about a pose holds kHeld.
double regionScale(const std::vector<Component>& all, const Pose& about, const Matrix6d& covariance) {
  struct Squares {
    double weight, mean, variance;
  };
  const Eigen::LLT<Matrix6d> cholesky(covariance);
  std::vector<Squares> squares;
  for (const Component& component : all) {
    const Vector6d m = cholesky.matrixL().solve(poseError(component.T_map_base, about));
    const Matrix6d half = cholesky.matrixL().solve(component.covariance);
    const Matrix6d S = cholesky.matrixL().solve(half.transpose());
    squares.push_back(
        {component.weight, m.squaredNorm() + S.trace(), 2 * S.squaredNorm() + 4 * m.dot(S * m)});
  }
  double low = 0.05, high = 20.0;
  for (int i = 0; i < 20; ++i) {  // bisection, of the logarithm
    const double middle = std::sqrt(low * high);
    double held = 0.0, sum = 0.0;
    for (const Squares& s : squares) {
      held += s.weight * probabilityBelow(middle * kRegion95, s.mean, s.variance);
      sum += s.weight;
    }
    (held < kHeld * sum ? low : high) = middle;
  }
  return high;
}

// Share of each group or hypothesis.
std::map<size_t, double> shares(const std::vector<Component>& all, size_t Component::*key) {
  std::map<size_t, double> share;
  double sum = 0.0;
  for (const Component& component : all) sum += component.weight;
  for (const Component& component : all) share[component.*key] += component.weight / sum;
  return share;
}

// Whether the pose scatters about a minimum as that one says. Nearly head-on, where two meet in one, the
// valley is flat or lopsided, and which of two poses it is has no answer.
bool standsAlone(const std::vector<Component>& all, size_t hypothesis, const PoseHypothesis& minimum) {
  std::vector<Component> own;
  std::copy_if(all.begin(), all.end(), std::back_inserter(own),
               [&](const Component& component) { return component.hypothesis == hypothesis; });
  const Matrix6d moment = secondMoment(own, minimum.T_map_base);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> ratio(
      moment.bottomRightCorner<3, 3>(), minimum.covariance.bottomRightCorner<3, 3>(), Eigen::EigenvaluesOnly);
  return ratio.eigenvalues()[0] * kLikeMinimum > 1 && ratio.eigenvalues()[2] < kLikeMinimum;
}

size_t largest(const std::map<size_t, double>& share) {
  return std::max_element(share.begin(), share.end(), [](auto& a, auto& b) { return a.second < b.second; })
      ->first;
}

// Of the most probable group, the hypothesis that is most probable with what the prior says of it.
size_t bestHypothesis(const std::vector<Component>& group, const std::vector<PoseHypothesis>& hypotheses) {
  auto share = shares(group, &Component::hypothesis);
  for (auto& [hypothesis, weight] : share) weight = std::log(weight) + hypotheses[hypothesis].log_prior;
  return largest(share);
}

}  // namespace

PosePosterior posePosterior(const std::vector<MarkerSighting>& sightings,
                            const std::vector<PoseHypothesis>& hypotheses, const PosteriorParams& params) {
  auto all = components(sightings, hypotheses, params);
  const auto by_group = shares(all, &Component::group);
  const size_t group = largest(by_group);
  std::vector<Component> probable;
  std::copy_if(all.begin(), all.end(), std::back_inserter(probable),
               [&](const Component& component) { return component.group == group; });
  if (by_group.at(group) >= params.decided) all = probable;
  PosePosterior posterior;
  posterior.best = bestHypothesis(probable, hypotheses);
  posterior.probability = shares(all, &Component::hypothesis).at(posterior.best);
  if (!standsAlone(all, posterior.best, hypotheses[posterior.best]))
    posterior.probability = std::min(posterior.probability, 0.5);
  const Pose& about = hypotheses[posterior.best].T_map_base;
  posterior.covariance = secondMoment(all, about);
  if (posterior.probability < params.decided)
    posterior.covariance *= std::max(1.0, regionScale(all, about, posterior.covariance));
  return posterior;
}

}  // namespace sextant
