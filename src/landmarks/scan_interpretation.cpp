// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/scan_interpretation.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDeviations = 3.0;  // tolerated pose error

// A slip of odometry between two scans with landmarks: its probability, and its standard deviations.
const double kLogSlip = std::log(0.01);
constexpr double kSlip = 0.5, kSlipTurn = 0.3;  // metres, radians
constexpr double kMargin = 1.0;                 // metres around the mapped landmarks
constexpr double kLeastUnknown = 0.02;          // share of landmarks that are unknown where the sensor looked
constexpr double kMinUnconfirmed = 0.5;         // metres and radians driven

/// Adds the covariance of a slip to that of predicted observations.
void addSlip(ObservationPrediction& expected) {
  MatrixXd G(expected.positions.size(), 3);
  for (Eigen::Index i = 0; i < expected.positions.size() / 2; ++i) {
    G.block<2, 2>(2 * i, 0).setIdentity();
    G.block<2, 1>(2 * i, 2) = perpendicular(expected.positions.segment<2>(2 * i));
  }
  if (expected.positions.size() % 2 == 1) G.bottomRows<1>() << 0, 0, 1;  // one landmark with a heading
  expected.covariance += G * slipCovariance() * G.transpose();
}

bool isAssociated(const Association& each) { return each.outcome == Outcome::associated; }

class Interpreter {
 public:
  Interpreter(LandmarkRegister& map, const MapKnowledge& knowledge) : map_(map), knowledge_(knowledge) {}

  std::vector<ScanInterpretation> run(const std::vector<LabelledObservation>& seen,
                                      const Pose2& T_base_sensor, size_t most) {
    std::vector<ScanInterpretation> all = explained(seen, T_base_sensor, most, false);
    if (most > 1 && maySlip(all.front(), seen))
      for (ScanInterpretation& each : explained(seen, T_base_sensor, most, true))
        if (std::any_of(each.outcomes.begin(), each.outcomes.end(), isAssociated)) all.push_back(each);
    const auto is_more_likely = [](const ScanInterpretation& a, const ScanInterpretation& b) {
      return a.log_likelihood > b.log_likelihood;
    };
    std::stable_sort(all.begin(), all.end(), is_more_likely);
    if (all.size() > most) all.resize(most);
    return all;
  }

 private:
  /// Landmarks that may be in view from any likely pose, and those that the observations may be of.
  /// @param more further uncertainty of the robot's position, metres
  std::vector<size_t> inReach(const std::vector<LabelledObservation>& observations, double more) const {
    const double off =
        kDeviations * largestDeviation(map_.filter().covariance({}).topLeftCorner<2, 2>()) + more;
    const auto may_be = [off](const LabelledObservation& each, double range) {
      const double deviation = largestDeviation(each.observation.covariance.topLeftCorner<2, 2>());
      return std::abs(each.observation.position.norm() - range) < 2 * kDeviations * deviation + off;
    };
    const auto& landmarks = map_.filter().landmarks();
    std::vector<size_t> found;
    for (size_t i = 0; i < landmarks.size(); ++i) {
      const double range = (landmarks[i].position - map_.filter().pose().position).norm();
      if (range < knowledge_.sensor.maxRange() + off ||
          std::any_of(observations.begin(), observations.end(),
                      [&](const auto& each) { return may_be(each, range); }))
        found.push_back(i);
    }
    return found;
  }

  /// An id determines the landmark, unless the observation is outside of its gate.
  JointAssociation associateById(const LabelledObservation& observation, bool slipped) {
    const auto which = map_.find(observation.label);
    const double log_density_of_none = logDensityOfNew(observation);
    if (!which) return {{{}}, log_density_of_none};
    const Landmark2D& landmark = map_.filter().landmarks()[*which];
    const bool heading = commonDimension(observation.observation, landmark) == 3;
    const std::vector<AssociatedObservation> seen{{*which, observation.observation}};
    const Eigen::VectorXd off = innovations(seen, {toRobotFrame(map_.filter().pose(), landmark)});
    ObservationPrediction expected = map_.filter().predictObservations({*which}, heading);
    if (slipped) addSlip(expected);
    const MatrixXd S = expected.covariance + observationNoise(seen, map_.filter().landmarks());
    const double gate = quantile(boost::math::chi_squared(static_cast<double>(off.size())),
                                 knowledge_.association.new_landmark_gate);
    const double distance = off.dot(S.llt().solve(off));
    if (distance > gate) return {{{Outcome::ambiguous, *which}}, log_density_of_none};
    const Eigen::Matrix2d S_position = S.topLeftCorner<2, 2>();
    const Vector2d off_position = off.head<2>();
    return {{{Outcome::associated, *which}},
            logDensity(off_position.dot(S_position.llt().solve(off_position)),
                       std::sqrt(S_position.determinant()))};
  }

  /// Whether something new is where only known landmarks were expected, after a drive that no landmark
  /// confirmed: then the error of odometry may be larger than its covariance.
  bool maySlip(const ScanInterpretation& how, const std::vector<LabelledObservation>& observations) const {
    if (knowledge_.unconfirmed < kMinUnconfirmed || map_.labels().empty()) return false;
    if (std::any_of(how.outcomes.begin(), how.outcomes.end(), isAssociated)) return false;
    return std::any_of(observations.begin(), observations.end(), [&](const LabelledObservation& each) {
      return logDensityOfNone(each) <= logDensityOfNew(each);
    });
  }

  std::vector<size_t> expectedInView(const ObservationPrediction& expected,
                                     const Pose2& T_base_sensor) const {
    if (knowledge_.detects == Detects::with_id) return {};
    return knowledge_.sensor.expectedInView(expected, T_base_sensor);
  }

  std::vector<ScanInterpretation> explained(const std::vector<LabelledObservation>& observations,
                                            const Pose2& T_base_sensor, size_t most, bool slipped) {
    const std::vector<size_t> near = inReach(observations, slipped ? kDeviations * kSlip : 0);
    ObservationPrediction expected = map_.filter().predictObservations(near);
    if (slipped) addSlip(expected);
    std::vector<LandmarkPoint> points;
    for (size_t k = 0; k < near.size(); ++k)
      points.push_back({expected.positions.segment<2>(2 * k), map_.labels()[near[k]]});
    std::vector<PositionObservation> seen;
    std::vector<double> log_density_of_none;
    std::vector<JointAssociation> by_id;
    for (const LabelledObservation& each : observations) {
      const Observation2D& observation = each.observation;
      if (each.label.id) {
        by_id.push_back(associateById(each, slipped));
      } else {
        seen.push_back({observation.position, observation.covariance.topLeftCorner<2, 2>(), each.label});
        log_density_of_none.push_back(logDensityOfNone(each));
      }
    }
    std::vector<ScanInterpretation> all;
    const std::vector<size_t> in_view = expectedInView(expected, T_base_sensor);
    for (const JointAssociation& each :
         associations(points, expected.covariance, seen, log_density_of_none, knowledge_.association, most)) {
      ScanInterpretation how = combined(each, by_id, observations, near);
      how.slipped = slipped;
      if (slipped) how.log_likelihood += kLogSlip;
      // A printed marker is visible from the front only: a missed detection is no evidence of its absence,
      // but a detection elsewhere is.
      for (const size_t which : in_view)
        if (!map_.labels()[near[which]].id) how.in_view.push_back(near[which]);
      addExpectations(how);
      all.push_back(how);
    }
    return all;
  }

  /// Landmark indices of the whole map, and the observations in their order.
  ScanInterpretation combined(const JointAssociation& by_position, const std::vector<JointAssociation>& by_id,
                              const std::vector<LabelledObservation>& observations,
                              const std::vector<size_t>& near) const {
    ScanInterpretation how;
    how.log_likelihood = by_position.log_likelihood;
    auto next_id = by_id.begin();
    auto next = by_position.outcomes.begin();
    for (const LabelledObservation& each : observations) {
      if (each.label.id) {
        how.outcomes.push_back(next_id->outcomes.front());
        how.log_likelihood += next_id++->log_likelihood;
      } else {
        how.outcomes.push_back(*next++);
        if (isAssociated(how.outcomes.back()))
          how.outcomes.back().landmark = near[how.outcomes.back().landmark];
      }
    }
    return how;
  }

  /// Adds the probability of missing what is expected in view.
  void addExpectations(ScanInterpretation& how) const {
    std::vector<size_t> observed;
    for (const Association& each : how.outcomes)
      if (isAssociated(each)) observed.push_back(each.landmark);
    const auto is_missed = [&](size_t landmark) {
      return std::find(observed.begin(), observed.end(), landmark) == observed.end();
    };
    for (const size_t landmark : how.in_view)
      if (is_missed(landmark) && map_.isUnlikelyMiss(landmark, observed))
        how.log_likelihood += std::log(1 - knowledge_.sensor.detectionProbability());
  }

  /// Landmarks with a label are about as dense where the map does not know them yet as where it does. Where
  /// the sensor looked, those are left that it missed each time.
  double logDensityOfNew(const LabelledObservation& seen) const {
    Vector2d low = map_.filter().pose().position, high = low;
    double same = 1;
    for (size_t i = 0; i < map_.labels().size(); ++i) {
      low = low.cwiseMin(map_.filter().landmarks()[i].position);
      high = high.cwiseMax(map_.filter().landmarks()[i].position);
      same += map_.labels()[i].class_name == seen.label.class_name;
    }
    const double area = (high - low + Vector2d::Constant(2 * kMargin)).prod();
    const int looks = knowledge_.explored.looks(inMap(map_.filter().pose(), seen).position);
    const double unknown = std::pow(1 - knowledge_.sensor.detectionProbability(), looks);
    return std::log(same / area * std::max(kLeastUnknown, unknown));
  }

  /// If it is not of a landmark in the map: of a candidate, or of something new.
  double logDensityOfNone(const LabelledObservation& seen) const {
    const double density_of_new = logDensityOfNew(seen);
    const auto of = [&](const LandmarkCandidates& some) {
      return some.logDensityOf(inMap(map_.filter().pose(), seen)).value_or(density_of_new);
    };
    return std::max({density_of_new, of(knowledge_.candidates), of(knowledge_.unused)});
  }

  LandmarkRegister& map_;
  const MapKnowledge& knowledge_;
};

}  // namespace

Matrix3d slipCovariance() { return Vector3d(kSlip, kSlip, kSlipTurn).cwiseAbs2().asDiagonal(); }

std::vector<ScanInterpretation> interpretScan(LandmarkRegister& map, const MapKnowledge& knowledge,
                                              const std::vector<LabelledObservation>& observations,
                                              const Pose2& T_base_sensor, size_t most) {
  return Interpreter(map, knowledge).run(observations, T_base_sensor, most);
}

}  // namespace sextant
