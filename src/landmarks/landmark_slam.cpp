// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_slam.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kDeviations = 3.0;     // tolerated pose error
constexpr size_t kMinProvisional = 4;   // provisional landmarks needed to match them with the map
constexpr size_t kMaxProvisional = 12;  // above which unmatched ones are established as new
constexpr double kMinOffset = 1.0;      // metres, and
constexpr double kMinTurn = 0.35;       // radians: minimum pose error of a kidnapped robot
constexpr int kMatchingInterval =
    10;  // scans between two matchings of a lost robot whose local map does not grow

bool contains(const std::vector<size_t>& all, size_t one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

long countLabels(const LandmarkLabel& label, const std::vector<LabelledObservation>& observations) {
  return std::count_if(observations.begin(), observations.end(),
                       [&](const auto& each) { return each.label == label; });
}

}  // namespace

ParamList LandmarkSlamParams::fields() {
  const ParamList own = {
      {"read_only", &read_only, Allowed(), "",
       "no landmark is added, merged or removed; the positions of mapped landmarks are still refined"},
      {"lost_after", &lost_after, Range::closed(0, 10000), "",
       "number of scans that contradict the map after which the robot is lost; each scan that confirms the "
       "map cancels three of them; 0: never"},
  };
  return joined({sensor.fields(), prefixed("candidate_", candidates.fields()), association.fields(), own,
                 prefixed("match_", matching.fields()), filter.fields()});
}

LandmarkSlam::LandmarkSlam(const LandmarkSlamParams& params, const Pose2& T_map_base,
                           const Matrix3d& covariance)
    : params_(params),
      sensor_(params.sensor),
      register_(params.filter, T_map_base, covariance),
      candidates_(params.candidates),
      kidnap_detector_(params.lost_after) {
  validate(params);
}

void LandmarkSlam::predict(const OdometryStep& step, double duration) {
  register_.filter().predict(step, duration);
  for (LandmarkSlam& local : local_) local.predict(step, duration);
}

LandmarkReport LandmarkSlam::observe(double stamp, const std::vector<LabelledObservation>& observations,
                                     const Pose2& T_base_sensor) {
  return isLost() ? observeLost(stamp, observations, T_base_sensor)
                  : observeLocalized(stamp, observations, T_base_sensor);
}

LandmarkReport LandmarkSlam::observeLocalized(double stamp,
                                              const std::vector<LabelledObservation>& observations,
                                              const Pose2& T_base_sensor) {
  const std::vector<size_t> near = inReach(observations);
  LandmarkReport report;
  const ScanAssociation scan = associateScan(near, observations, T_base_sensor, report);
  register_.filter().update(scan.known);
  if (report.associated > 0) report.nis = filter().nis(), report.nis_dof = filter().nisDof();
  detectKidnapping(scan, report);
  if (isLost()) {
    report.lost = true;
  } else if (!params_.read_only) {
    // Observed landmarks confirm the pose: only then a missed one is evidence of its absence.
    register_.addEvidence(scan.observed, sensor_.evidence(true));
    if (!scan.observed.empty()) {
      countDetections(scan);
      register_.addEvidence(scan.missed, sensor_.evidence(false));
      register_.addEvidence(scan.relocated, sensor_.evidence(false));
    }
    initialize(stamp, scan.unknown, report);
    report.merged = register_.mergeDuplicates(scan.observed, params_.sensor.min_separation, report.keys);
    report.removed = register_.removeUnlikely();
  }
  return report;
}

/// A landmark counts only in scans that detect another one, as only in these it is evidence to miss it.
void LandmarkSlam::countDetections(const ScanAssociation& scan) {
  const auto is_established = [this](size_t each) { return register_.isEstablished(each); };
  const auto count = [&](const std::vector<size_t>& all) {
    return static_cast<int>(std::count_if(all.begin(), all.end(), is_established));
  };
  sensor_.count(scan.observed.size() > 1 ? count(scan.detected) : 0, count(scan.missed));
}

// ---- data association

/// Landmarks that may be in view from any likely pose, and those that the observations may be of.
std::vector<size_t> LandmarkSlam::inReach(const std::vector<LabelledObservation>& observations) const {
  const double off = kDeviations * largestDeviation(filter().covariance({}).topLeftCorner<2, 2>());
  const auto may_be = [off](const LabelledObservation& each, double range) {
    const double deviation = largestDeviation(each.observation.covariance.topLeftCorner<2, 2>());
    return std::abs(each.observation.position.norm() - range) < 2 * kDeviations * deviation + off;
  };
  const auto& landmarks = filter().landmarks();
  std::vector<size_t> found;
  for (size_t i = 0; i < landmarks.size(); ++i) {
    const double range = (landmarks[i].position - filter().pose().position).norm();
    if (range < params_.sensor.max_range + off ||
        std::any_of(observations.begin(), observations.end(),
                    [&](const auto& each) { return may_be(each, range); }))
      found.push_back(i);
  }
  return found;
}

LandmarkSlam::ScanAssociation LandmarkSlam::associateScan(
    const std::vector<size_t>& near, const std::vector<LabelledObservation>& observations,
    const Pose2& T_base_sensor, LandmarkReport& report) {
  const ObservationPrediction expected = register_.filter().predictObservations(near);
  ScanAssociation scan = groupByOutcome(associateAll(near, expected, observations), observations, report);
  // A printed marker is visible from the front only: a missed detection is no evidence of its absence, but a
  // detection elsewhere is.
  for (const size_t which : sensor_.expectedInView(expected, T_base_sensor))
    if (!labels()[near[which]].id)
      (contains(scan.observed, near[which]) ? scan.detected : scan.missed).push_back(near[which]);
  return scan;
}

LandmarkSlam::ScanAssociation LandmarkSlam::groupByOutcome(
    const std::vector<Association>& outcomes, const std::vector<LabelledObservation>& observations,
    LandmarkReport& report) const {
  report.keys.resize(observations.size());
  ScanAssociation scan;
  for (size_t i = 0; i < observations.size(); ++i) {
    const auto& [outcome, landmark] = outcomes[i];
    const bool is_twin =
        outcome == Outcome::associated && contains(scan.observed, landmark);  // the same id twice in one scan
    if (outcome == Outcome::associated && !is_twin) {
      scan.known.push_back({landmark, observations[i].observation});
      scan.observed.push_back(landmark);
      report.keys[i] = keys()[landmark];
      ++report.associated;
    } else if (outcome == Outcome::unassociated) {
      scan.unknown.push_back(observations[i]);
    } else if (observations[i].label.id && !is_twin) {
      ++report.rejected;
      scan.relocated.push_back(landmark);
    } else {
      ++report.ambiguous;
    }
  }
  return scan;
}

std::vector<Association> LandmarkSlam::associateAll(const std::vector<size_t>& near,
                                                    const ObservationPrediction& expected,
                                                    const std::vector<LabelledObservation>& observations) {
  std::vector<LandmarkPoint> points;
  for (size_t k = 0; k < near.size(); ++k)
    points.push_back({expected.positions.segment<2>(2 * k), labels()[near[k]]});
  std::vector<PositionObservation> seen;
  for (const LabelledObservation& each : observations)
    if (!each.label.id)
      seen.push_back(
          {each.observation.position, each.observation.covariance.topLeftCorner<2, 2>(), each.label});
  const std::vector<Association> by_position =
      associate(points, expected.covariance, seen, params_.association);

  std::vector<Association> found;
  for (size_t i = 0, k = 0; i < observations.size(); ++i) {
    found.push_back(observations[i].label.id ? associateById(observations[i]) : by_position[k++]);
    if (!observations[i].label.id && found[i].outcome == Outcome::associated)
      found[i].landmark = near[found[i].landmark];
  }
  return found;
}

/// An id determines the landmark, unless the observation is outside of its gate.
Association LandmarkSlam::associateById(const LabelledObservation& observation) {
  const auto which = register_.find(observation.label);
  if (!which) return {};
  const Landmark2D& landmark = filter().landmarks()[*which];
  const bool heading = commonDimension(observation.observation, landmark) == 3;
  const std::vector<AssociatedObservation> seen{{*which, observation.observation}};
  const Eigen::VectorXd off = innovations(seen, {toRobotFrame(filter().pose(), landmark)});
  const MatrixXd S = register_.filter().predictObservations({*which}, heading).covariance +
                     observationNoise(seen, filter().landmarks());
  const double gate = quantile(boost::math::chi_squared(static_cast<double>(off.size())),
                               params_.association.new_landmark_gate);
  return {off.dot(S.llt().solve(off)) < gate ? Outcome::associated : Outcome::ambiguous, *which};
}

/// A landmark of which only the class is known would match all observations of its class.
bool LandmarkSlam::canInitialize(const LabelledObservation& seen) const {
  return seen.can_initialize &&
         largestDeviation(seen.observation.covariance.topLeftCorner<2, 2>()) < params_.sensor.max_range;
}

void LandmarkSlam::initialize(double stamp, const std::vector<LabelledObservation>& unknown,
                              LandmarkReport& report) {
  const Matrix2d R = rotation2(filter().pose().heading);
  std::vector<LabelledObservation> first;
  for (const LabelledObservation& each : unknown) {
    const bool is_twin = each.label.id && countLabels(each.label, unknown) > 1;
    if (is_twin) ++report.ambiguous;
    if (canInitialize(each) && !is_twin) first.push_back(each);
  }
  std::vector<PositionObservation> in_map;
  for (const LabelledObservation& each : first)
    in_map.push_back({filter().pose() * each.observation.position,
                      R * each.observation.covariance.topLeftCorner<2, 2>() * R.transpose(), each.label});
  const std::vector<bool> is_landmark = candidates_.observe(stamp, in_map);
  for (size_t i = 0; i < first.size(); ++i) {
    if (is_landmark[i]) register_.add(first[i]);
    ++(is_landmark[i] ? report.initialized : report.tentative);
  }
}

// ---- kidnapping and relocalization

void LandmarkSlam::detectKidnapping(const ScanAssociation& scan, const LandmarkReport& report) {
  KidnapDetector::Evidence evidence;
  for (const size_t landmark : scan.observed) evidence.observed.push_back(keys()[landmark]);
  for (const size_t landmark : scan.missed) evidence.missed.push_back(keys()[landmark]);
  evidence.unknown = static_cast<int>(scan.unknown.size());
  evidence.contradictions = report.rejected;
  if (params_.read_only) evidence.contradictions += evidence.unknown / 2;  // not all are false alarms
  evidence.next_key = register_.nextKey();
  kidnap_detector_.update(evidence);
  const bool is_consistent =
      kidnap_detector_.isConsistent() && kidnap_detector_.firstProvisional() == register_.nextKey();
  if (is_consistent) trusted_.reset(), matched_size_ = 0;
  if (!is_consistent && !trusted_) trusted_ = std::make_shared<const LandmarkRegister>(register_);
  if (kidnap_detector_.isLost() || provisionalLandmarksMatchElsewhere()) relocalize();
}

/// Whether the provisional landmarks match the established map at another pose.
bool LandmarkSlam::provisionalLandmarksMatchElsewhere() {
  std::vector<MapPoint> provisional, established;
  const std::vector<MapPoint> all = register_.points();
  for (size_t i = 0; i < all.size(); ++i)
    (keys()[i] < kidnap_detector_.firstProvisional() ? established : provisional).push_back(all[i]);
  if (params_.lost_after < 1 || provisional.size() < kMinProvisional || provisional.size() == matched_size_)
    return false;
  matched_size_ = provisional.size();
  const auto match = matchLandmarkMaps(provisional, established, params_.matching);
  if (!match && provisional.size() >= kMaxProvisional) kidnap_detector_.confirm(register_.nextKey());
  if (!match) return false;
  const Pose2 matched = match->T_map_local * filter().pose();
  return (matched.position - filter().pose().position).norm() > kMinOffset ||
         std::abs(wrapped(match->T_map_local.heading)) > kMinTurn;
}

void LandmarkSlam::relocalize() {
  const Pose2 pose = filter().pose();
  const Matrix3d covariance = filter().covariance({});
  const int first_provisional = kidnap_detector_.firstProvisional();
  if (trusted_) register_ = *trusted_;
  register_.removeFrom(first_provisional);
  setPose(pose, covariance);
  if (labels().empty()) return;
  LandmarkSlamParams params = params_;
  params.read_only = false;
  params.lost_after = 0;
  const double variance = 1e-6;  // square metres and radians: the local frame begins at the robot
  local_ = {LandmarkSlam(params, Pose2{}, variance * Matrix3d::Identity())};
}

/// Matches the local map in the robot frame: there, the landmarks observed last are precise, however far the
/// robot drove while it was lost.
LandmarkReport LandmarkSlam::observeLost(double stamp, const std::vector<LabelledObservation>& observations,
                                         const Pose2& T_base_sensor) {
  LandmarkReport report = local_.front().observe(stamp, observations, T_base_sensor);
  std::fill(report.keys.begin(), report.keys.end(), std::nullopt);
  report.tentative = static_cast<int>(observations.size());
  report.associated = report.ambiguous = report.nis_dof = 0;
  if (report.initialized > 0 || ++lost_scans_ % kMatchingInterval == 0)
    if (const auto match = matchLandmarkMaps(local_.front().register_.pointsInRobotFrame(),
                                             register_.points(), params_.matching))
      applyMatch(*match);
  report.initialized = 0;
  report.lost = isLost();
  return report;
}

/// Observes the matched landmarks of the map with the joint covariance of the local ones, in one update.
/// @param match with the local map in the robot frame
void LandmarkSlam::applyMatch(const LandmarkMapMatch& match) {
  std::vector<size_t> of_local;
  bool headings = true;  // whether all of them have one in both maps
  for (const auto& [own, of_map] : match.pairs) {
    of_local.push_back(own);
    headings =
        headings && local_.front().filter().landmarks()[own].heading && filter().landmarks()[of_map].heading;
  }
  const ObservationPrediction seen =
      local_.front().register_.filter().predictObservations(of_local, headings);
  std::vector<AssociatedObservation> observations;
  Eigen::Index at = 0;
  for (const auto& pair : match.pairs) {
    Observation2D observation{seen.positions.segment<2>(at), {}, Matrix3d::Zero()};
    at += 2;
    if (headings) observation.heading = seen.positions(at++);
    observations.push_back({pair.second, observation});
  }
  const Vector3d around(0.5, 0.5, 0.3);  // metres and radians: much larger than the error of a match
  setPose(match.T_map_local, around.cwiseAbs2().asDiagonal());
  register_.filter().update(observations, seen.covariance);
}

void LandmarkSlam::setPose(const Pose2& T_map_base, const Matrix3d& covariance) {
  register_.filter().setPose(T_map_base, covariance);
  clearHypotheses();
}

void LandmarkSlam::setMap(const Pose2& T_map_base, const std::vector<Landmark2D>& landmarks,
                          const std::vector<LandmarkLabel>& labels, const MatrixXd& covariance) {
  register_.setMap(T_map_base, landmarks, labels, covariance);
  clearHypotheses();
}

void LandmarkSlam::clearHypotheses() {
  candidates_.clear();
  local_.clear();
  trusted_.reset();
  matched_size_ = 0;
  kidnap_detector_ = KidnapDetector(params_.lost_after);
  kidnap_detector_.confirm(register_.nextKey());
}

}  // namespace sextant
