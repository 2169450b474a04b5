// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_association.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <stdexcept>

namespace sextant {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr int kNone = -1;

/// Gate on the squared Mahalanobis distance of a joint hypothesis: chi-squared quantile, two degrees of
/// freedom per pair.
double squaredGate(double probability, size_t pairs) {
  return quantile(boost::math::chi_squared(2.0 * static_cast<double>(pairs)), probability);
}

/// A joint hypothesis: its pairs, the Cholesky factor of their innovation covariance, and the whitened
/// innovations.
struct JointHypothesis {
  MatrixXd cholesky_factor;
  VectorXd whitened;
  std::vector<std::pair<int, int>> pairs;  // observation, landmark

  double distance() const { return whitened.squaredNorm(); }
  double jointLogDensity() const {
    double sum = 0;
    for (Index at = 0; at < whitened.size(); at += 2)
      sum +=
          logDensity(whitened.segment<2>(at).squaredNorm(), cholesky_factor.diagonal().segment<2>(at).prod());
    return sum;
  }
};

/// A joint hypothesis in which the observations of no landmark have been decided, too.
struct Decided {
  JointHypothesis joint;
  std::vector<Association> outcomes;
  double log_density_of_rest = 0;

  double logLikelihood() const { return joint.jointLogDensity() + log_density_of_rest; }
};

class JointSearch {
 public:
  JointSearch(const std::vector<LandmarkPoint>& landmarks, const MatrixXd& covariance,
              const std::vector<PositionObservation>& observations, const AssociationParams& params)
      : landmarks_(landmarks), covariance_(covariance), observations_(observations), params_(params) {
    for (size_t pairs = 1; pairs <= observations.size(); ++pairs)
      gates_.push_back(squaredGate(params.gate, pairs));
    for (const PositionObservation& observation : observations)
      compatible_.push_back(individuallyCompatible(observation, gates_[0]));
  }

  std::vector<JointAssociation> run(const std::vector<double>& log_density_of_none, size_t most) {
    branch(0, {}, static_cast<int>(observations_.size()));
    const std::vector<double> of_new(observations_.size(), std::log(params_.new_landmark_density));
    Decided certain;
    certain.outcomes = bestOutcomes(most > 1 ? log_density_of_none : of_new);
    for (const auto& [i, j] : best_.pairs)
      if (certain.outcomes[i].outcome == Outcome::associated) certain.joint = extended(certain.joint, i, j);
    std::vector<size_t> open;
    for (size_t i = 0; i < observations_.size(); ++i) {
      if (most > 1 && isOpen(certain, i)) {
        open.push_back(i);
      } else if (certain.outcomes[i].outcome != Outcome::associated) {
        certain.log_density_of_rest += log_density_of_none[i];
      }
    }
    std::vector<Decided> all{certain};
    for (const size_t i : open) all = decided(all, static_cast<int>(i), log_density_of_none[i], most);
    std::vector<JointAssociation> found;
    for (const Decided& each : all) found.push_back({each.outcomes, each.logLikelihood()});
    return found;
  }

 private:
  bool isOpen(const Decided& certain, size_t observation) const {
    return certain.outcomes[observation].outcome == Outcome::ambiguous && !compatible_[observation].empty();
  }

  /// Decides about one more observation; keeps the most likely results.
  std::vector<Decided> decided(const std::vector<Decided>& before, int observation,
                               double log_density_of_none, size_t most) const {
    std::vector<Decided> after;
    for (const Decided& each : before) {
      after.push_back(each);
      after.back().log_density_of_rest += log_density_of_none;
      for (const int landmark : compatible_[observation]) {
        if (isTaken(each.joint, landmark)) continue;
        const JointHypothesis joint = extended(each.joint, observation, landmark);
        if (joint.distance() > gates_[joint.pairs.size() - 1]) continue;
        after.push_back({joint, each.outcomes, each.log_density_of_rest});
        after.back().outcomes[observation] = {Outcome::associated, static_cast<size_t>(landmark)};
      }
    }
    const auto is_more_likely = [](const Decided& a, const Decided& b) {
      return a.logLikelihood() > b.logLikelihood();
    };
    std::stable_sort(after.begin(), after.end(), is_more_likely);
    if (after.size() > most) after.resize(most);
    return after;
  }

  /// Of the best hypothesis; what is not certain is ambiguous.
  std::vector<Association> bestOutcomes(const std::vector<double>& log_density_of_none) const {
    std::vector<Association> found(observations_.size());
    for (const auto& [observation, landmark] : best_.pairs)
      found[observation] = {isUnambiguous(observation, log_density_of_none[observation]) ? Outcome::associated
                                                                                         : Outcome::ambiguous,
                            static_cast<size_t>(landmark)};
    for (size_t i = 0; i < found.size(); ++i)
      if (found[i].outcome == Outcome::unassociated && isInsideOuterGate(observations_[i]))
        found[i].outcome = Outcome::ambiguous;
    return found;
  }

  /// Extends a joint hypothesis by one pair.
  JointHypothesis extended(const JointHypothesis& joint, int observation, int landmark) const {
    const Index size = joint.whitened.size();
    MatrixXd cross(2, size);
    for (size_t k = 0; k < joint.pairs.size(); ++k)
      cross.middleCols<2>(2 * k) = covariance_.block<2, 2>(2 * landmark, 2 * joint.pairs[k].second);
    const MatrixXd along = joint.cholesky_factor.triangularView<Eigen::Lower>().solve(cross.transpose());
    const Matrix2d rest = covariance_.block<2, 2>(2 * landmark, 2 * landmark) +
                          observations_[observation].covariance - along.transpose() * along;
    const Matrix2d root = rest.llt().matrixL();
    JointHypothesis more{MatrixXd::Zero(size + 2, size + 2), VectorXd(size + 2), joint.pairs};
    more.cholesky_factor.topLeftCorner(size, size) = joint.cholesky_factor;
    more.cholesky_factor.bottomLeftCorner(2, size) = along.transpose();
    more.cholesky_factor.bottomRightCorner<2, 2>() = root;
    const Vector2d innovation = observations_[observation].position - landmarks_[landmark].position;
    more.whitened.head(size) = joint.whitened;
    more.whitened.tail<2>() =
        root.triangularView<Eigen::Lower>().solve(innovation - along.transpose() * joint.whitened);
    more.pairs.emplace_back(observation, landmark);
    return more;
  }

  double individualDistance(const PositionObservation& observation, int landmark) const {
    const Vector2d innovation = observation.position - landmarks_[landmark].position;
    const Matrix2d S = covariance_.block<2, 2>(2 * landmark, 2 * landmark) + observation.covariance;
    return innovation.dot(S.llt().solve(innovation));
  }

  std::vector<int> individuallyCompatible(const PositionObservation& observation, double gate) const {
    std::vector<std::pair<double, int>> found;
    for (size_t j = 0; j < landmarks_.size(); ++j) {
      if (!(landmarks_[j].label == observation.label)) continue;
      const double distance = individualDistance(observation, static_cast<int>(j));
      if (distance < gate) found.emplace_back(distance, static_cast<int>(j));
    }
    std::sort(found.begin(), found.end());
    std::vector<int> indices;
    for (const auto& each : found) indices.push_back(each.second);
    return indices;
  }
  /// Of a landmark that is not observed by another observation.
  bool isInsideOuterGate(const PositionObservation& observation) const {
    const std::vector<int> near =
        individuallyCompatible(observation, squaredGate(params_.new_landmark_gate, 1));
    return std::any_of(near.begin(), near.end(), [&](int landmark) { return !isTaken(best_, landmark); });
  }

  bool isBetter(const JointHypothesis& joint) const {
    if (joint.pairs.size() != best_.pairs.size()) return joint.pairs.size() > best_.pairs.size();
    return joint.distance() < best_.distance();
  }

  void branch(size_t observation, const JointHypothesis& joint, int left) {
    if (isBetter(joint)) best_ = joint;  // the remaining observations may stay unassociated
    if (left == 0 || joint.pairs.size() + left < best_.pairs.size() || hypotheses_ > params_.max_hypotheses)
      return;
    for (const int landmark : compatible_[observation]) {
      if (isTaken(joint, landmark)) continue;
      ++hypotheses_;
      const JointHypothesis more = extended(joint, static_cast<int>(observation), landmark);
      if (more.distance() < gates_[more.pairs.size() - 1]) branch(observation + 1, more, left - 1);
    }
    branch(observation + 1, joint, left - 1);
  }

  static bool isTaken(const JointHypothesis& joint, int landmark) {
    return std::any_of(joint.pairs.begin(), joint.pairs.end(),
                       [&](const auto& pair) { return pair.second == landmark; });
  }

  /// Whether neither another landmark nor a new one explains an observation nearly as well, given all other
  /// pairs.
  bool isUnambiguous(int observation, double log_density_of_none) const {
    JointHypothesis others;
    int chosen = kNone;
    for (const auto& [i, j] : best_.pairs) {
      if (i == observation) {
        chosen = j;
      } else {
        others = extended(others, i, j);
      }
    }
    const JointHypothesis all = extended(others, observation, chosen);
    const double distance = all.distance();
    const double own = distance - others.distance();
    // sqrt(det(2 pi S)), square metres
    const double area = 2 * M_PI * all.cholesky_factor.diagonal().tail<2>().prod();
    if (own + 2 * (std::log(area) + log_density_of_none) > -params_.new_landmark_margin) return false;
    return std::none_of(compatible_[observation].begin(), compatible_[observation].end(), [&](int other) {
      return other != chosen && !isTaken(others, other) &&
             extended(others, observation, other).distance() < distance + params_.ambiguity_margin;
    });
  }

  const std::vector<LandmarkPoint>& landmarks_;
  const MatrixXd& covariance_;
  const std::vector<PositionObservation>& observations_;
  const AssociationParams& params_;
  std::vector<double> gates_;  // of one pair, two pairs, ...
  // individually compatible landmarks of each observation, nearest first
  std::vector<std::vector<int>> compatible_;
  JointHypothesis best_;
  int hypotheses_ = 0;
};

}  // namespace

ParamList AssociationParams::fields() {
  return {
      {"gate", &gate, Range::openHigh(0.5, 1), "",
       "probability that a correct observation is inside the gate"},
      {"new_landmark_gate", &new_landmark_gate, Allowed(Range::openHigh(gate, 1), "[`gate`, 1)"), "",
       "probability that a correct observation is inside the outer gate: an observation outside of it may be "
       "of a new landmark; an unassociated one inside it is ambiguous and not used. Also the gate of "
       "observations with an id"},
      {"ambiguity_margin", &ambiguity_margin, Range::closed(0, 100), "",
       "minimum difference between the squared Mahalanobis distances to the second best and to the best "
       "landmark"},
      {"new_landmark_margin", &new_landmark_margin, Range::closed(0, 100), "",
       "as `ambiguity_margin`, but relative to the hypothesis that the landmark is new"},
      {"new_landmark_density", &new_landmark_density, Range::openLow(0, 1000), "1/m²",
       "with `hypotheses: 1`: density of landmarks of one class that are not in the map yet; otherwise it is "
       "estimated from the map"},
      {"max_hypotheses", &max_hypotheses, Range::closed(100, 1e9), "",
       "maximum number of joint hypotheses that one search evaluates"},
  };
}

std::vector<Association> associate(const std::vector<LandmarkPoint>& landmarks, const MatrixXd& covariance,
                                   const std::vector<PositionObservation>& observations,
                                   const AssociationParams& params) {
  const std::vector<double> unused(observations.size());
  return associations(landmarks, covariance, observations, unused, params, 1).front().outcomes;
}

std::vector<JointAssociation> associations(const std::vector<LandmarkPoint>& landmarks,
                                           const MatrixXd& covariance,
                                           const std::vector<PositionObservation>& observations,
                                           const std::vector<double>& log_density_of_none,
                                           const AssociationParams& params, size_t most) {
  return JointSearch(landmarks, covariance, observations, params).run(log_density_of_none, most);
}

}  // namespace sextant
