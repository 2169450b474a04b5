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

/// Squared distance that so many pairs stay within, with a probability.
double squaredGate(double probability, size_t pairs) {
  return quantile(boost::math::chi_squared(2.0 * static_cast<double>(pairs)), probability);
}

/// Pairs that are taken together: Cholesky factor of their innovations' covariance, and the whitened
/// innovations.
struct Joint {
  MatrixXd root;
  VectorXd white;
  std::vector<std::pair<int, int>> pairs;  // sighting, landmark

  double distance() const { return white.squaredNorm(); }
};

class JointSearch {
 public:
  JointSearch(const std::vector<LandmarkPoint>& landmarks, const MatrixXd& covariance,
              const std::vector<LandmarkPointSighting>& sightings, const AssociationParams& params)
      : landmarks_(landmarks), covariance_(covariance), sightings_(sightings), params_(params) {
    for (size_t pairs = 1; pairs <= sightings.size(); ++pairs)
      gates_.push_back(squaredGate(params.gate, pairs));
    for (const LandmarkPointSighting& sighting : sightings)
      compatible_.push_back(within(sighting, gates_[0]));
  }

  std::vector<Association> run() {
    branch(0, {}, static_cast<int>(sightings_.size()));
    std::vector<Association> found(sightings_.size());
    for (const auto& [sighting, landmark] : best_.pairs)
      found[sighting] = {isClear(sighting) ? Origin::known : Origin::doubtful, static_cast<size_t>(landmark)};
    for (size_t i = 0; i < found.size(); ++i)
      if (found[i].origin == Origin::unknown && isNear(sightings_[i])) found[i].origin = Origin::doubtful;
    return found;
  }

 private:
  /// The joint one with a pair more.
  Joint with(const Joint& joint, int sighting, int landmark) const {
    const Index size = joint.white.size();
    MatrixXd cross(2, size);
    for (size_t k = 0; k < joint.pairs.size(); ++k)
      cross.middleCols<2>(2 * k) = covariance_.block<2, 2>(2 * landmark, 2 * joint.pairs[k].second);
    const MatrixXd along = joint.root.triangularView<Eigen::Lower>().solve(cross.transpose());
    const Matrix2d rest = covariance_.block<2, 2>(2 * landmark, 2 * landmark) +
                          sightings_[sighting].covariance - along.transpose() * along;
    const Matrix2d root = rest.llt().matrixL();
    Joint more{MatrixXd::Zero(size + 2, size + 2), VectorXd(size + 2), joint.pairs};
    more.root.topLeftCorner(size, size) = joint.root;
    more.root.bottomLeftCorner(2, size) = along.transpose();
    more.root.bottomRightCorner<2, 2>() = root;
    const Vector2d innovation = sightings_[sighting].position - landmarks_[landmark].position;
    more.white.head(size) = joint.white;
    more.white.tail<2>() =
        root.triangularView<Eigen::Lower>().solve(innovation - along.transpose() * joint.white);
    more.pairs.emplace_back(sighting, landmark);
    return more;
  }

  double alone(const LandmarkPointSighting& sighting, int landmark) const {
    const Vector2d innovation = sighting.position - landmarks_[landmark].position;
    const Matrix2d S = covariance_.block<2, 2>(2 * landmark, 2 * landmark) + sighting.covariance;
    return innovation.dot(S.llt().solve(innovation));
  }

  std::vector<int> within(const LandmarkPointSighting& sighting, double gate) const {
    std::vector<std::pair<double, int>> found;
    for (size_t j = 0; j < landmarks_.size(); ++j) {
      if (!(landmarks_[j].label == sighting.label)) continue;
      const double distance = alone(sighting, static_cast<int>(j));
      if (distance < gate) found.emplace_back(distance, static_cast<int>(j));
    }
    std::sort(found.begin(), found.end());
    std::vector<int> indices;
    for (const auto& each : found) indices.push_back(each.second);
    return indices;
  }
  bool isNear(const LandmarkPointSighting& sighting) const {
    return !within(sighting, squaredGate(params_.doubt, 1)).empty();
  }

  bool isBetter(const Joint& joint) const {
    if (joint.pairs.size() != best_.pairs.size()) return joint.pairs.size() > best_.pairs.size();
    return joint.distance() < best_.distance();
  }

  void branch(size_t sighting, const Joint& joint, int left) {
    if (isBetter(joint)) best_ = joint;  // all others may be of nothing
    if (left == 0 || joint.pairs.size() + left < best_.pairs.size() || effort_ > params_.effort) return;
    for (const int landmark : compatible_[sighting]) {
      if (isTaken(joint, landmark)) continue;
      ++effort_;
      const Joint more = with(joint, static_cast<int>(sighting), landmark);
      if (more.distance() < gates_[more.pairs.size() - 1]) branch(sighting + 1, more, left - 1);
    }
    branch(sighting + 1, joint, left - 1);
  }

  static bool isTaken(const Joint& joint, int landmark) {
    return std::any_of(joint.pairs.begin(), joint.pairs.end(),
                       [&](const auto& pair) { return pair.second == landmark; });
  }

  /// Whether no other landmark explains a sighting nearly as well, with all other pairs as they are.
  bool isClear(int sighting) const {
    Joint others;
    int chosen = kNone;
    for (const auto& [i, j] : best_.pairs) {
      if (i == sighting) {
        chosen = j;
      } else {
        others = with(others, i, j);
      }
    }
    const Joint all = with(others, sighting, chosen);
    const double distance = all.distance();
    const double own = distance - others.distance();
    const double area = 2 * M_PI * all.root.diagonal().tail<2>().prod();  // sqrt(det(2 pi S)), square metres
    if (own + 2 * std::log(area * params_.density) > -params_.new_margin) return false;
    return std::none_of(compatible_[sighting].begin(), compatible_[sighting].end(), [&](int other) {
      return other != chosen && !isTaken(others, other) &&
             with(others, sighting, other).distance() < distance + params_.margin;
    });
  }

  const std::vector<LandmarkPoint>& landmarks_;
  const MatrixXd& covariance_;
  const std::vector<LandmarkPointSighting>& sightings_;
  const AssociationParams& params_;
  std::vector<double> gates_;                 // of one pair, two, ...
  std::vector<std::vector<int>> compatible_;  // landmarks of each sighting, the nearest first
  Joint best_;
  int effort_ = 0;
};

}  // namespace

ParamList AssociationParams::fields() {
  return {
      {"gate", &gate, Range::openHigh(0.5, 1), "",
       "probability within which a sighting is compatible with its landmark"},
      {"doubt", &doubt, Allowed(Range::openHigh(gate, 1), "[`gate`, 1)"), "",
       "beyond which it is of another thing; between the two it is not used"},
      {"margin", &margin, Range::closed(0, 100), "",
       "squared Mahalanobis distance by which the next best has to be worse"},
      {"new_margin", &new_margin, Range::closed(0, 100), "",
       "as `margin`, against being of a landmark that is not known yet"},
      {"density", &density, Range::openLow(0, 1000), "1/m²", "of those, a class, where the sensor looks"},
      {"effort", &effort, Range::closed(100, 1e9), "", "pairs that the joint search looks at, at most"},
  };
}

std::vector<Association> associate(const std::vector<LandmarkPoint>& landmarks, const MatrixXd& covariance,
                                   const std::vector<LandmarkPointSighting>& sightings,
                                   const AssociationParams& params) {
  return JointSearch(landmarks, covariance, sightings, params).run();
}

}  // namespace sextant
