// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_slam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr size_t kMinProvisional = 4;   // provisional landmarks needed to match them with the map
constexpr size_t kMaxProvisional = 12;  // above which unmatched ones are established as new
constexpr double kMinOffset = 1.0;      // metres, and
constexpr double kMinTurn = 0.35;       // radians: minimum pose error of a kidnapped robot
constexpr int kMatchingInterval =
    10;  // scans between two matchings of a lost robot whose local map does not grow

/// Evidence of a miss with the default sensor.
double usualMiss() {
  static const double evidence = LandmarkSensor(LandmarkSensorParams()).evidence(false);
  return evidence;
}

CandidateParams neverLandmarks(CandidateParams params) {
  params.observations = std::numeric_limits<int>::max();
  return params;
}

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
       "number of scans that contradict the map after which the robot is lost, a slip of odometry counts "
       "as three; each scan that confirms the map cancels three of them; 0: never"},
      {"hypotheses", &hypotheses, Range::closed(1, 20), "",
       "maximum number of states that are kept while it is open which landmarks were observed, or whether "
       "odometry slipped; each one costs as much as one filter; 1: ambiguous observations are not used"},
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
      unused_(neverLandmarks(params.candidates)),
      kidnap_detector_(params.lost_after) {
  validate(params);
}

void LandmarkSlam::predict(const OdometryStep& step, double duration) {
  register_.filter().predict({step.step, noise_.applied() * step.noise, step.distance, step.turn}, duration);
  unconfirmed_ += step.distance + std::abs(step.turn);
  for (LandmarkSlam& local : local_) local.predict(step, duration);
}

PoseEstimate2D LandmarkSlam::predictPose(const OdometryStep& step) const {
  return filter().predictPose({step.step, noise_.applied() * step.noise, step.distance, step.turn});
}

LandmarkReport LandmarkSlam::observe(double stamp, const std::vector<LabelledObservation>& observations,
                                     const Pose2& T_base_sensor) {
  return observe(stamp, observations, T_base_sensor, interpretations(observations, T_base_sensor, 1).front());
}

LandmarkReport LandmarkSlam::observe(double stamp, const std::vector<LabelledObservation>& observations,
                                     const Pose2& T_base_sensor, const ScanInterpretation& how) {
  if (isLost()) return observeLost(stamp, observations, T_base_sensor, how);
  return observeLocalized(stamp, corrected(observations, T_base_sensor), T_base_sensor, how);
}

/// Turned by the estimated error of the mount.
std::vector<LabelledObservation> LandmarkSlam::corrected(const std::vector<LabelledObservation>& observations,
                                                         const Pose2& T_base_sensor) const {
  std::vector<LabelledObservation> turned = observations;
  if (filter().bearingVariance() == 0) return turned;
  const Pose2 turn = T_base_sensor * Pose2{{0, 0}, filter().bearing()} * T_base_sensor.inverse();
  for (LabelledObservation& each : turned) each.observation = turn * each.observation;
  return turned;
}

LandmarkReport LandmarkSlam::observeLocalized(double stamp,
                                              const std::vector<LabelledObservation>& observations,
                                              const Pose2& T_base_sensor, const ScanInterpretation& how) {
  if (how.slipped) register_.filter().predict({Pose2{}, slipCovariance(), 0});
  LandmarkReport report;
  ScanAssociation scan = groupByOutcome(how, observations, report);
  for (const size_t each : how.in_view)
    (contains(scan.observed, each) ? scan.detected : scan.missed).push_back(each);
  compareWithMap(scan, report);
  register_.filter().update(scan.known);
  if (report.associated > 0) {
    unconfirmed_ = 0;
    report.nis = filter().nis(), report.nis_dof = filter().nisDof();
    if (!how.slipped) noise_.add(report.nis, report.nis_dof, filter().nisStateShare());
  }
  noteView(scan, T_base_sensor);
  unused_.observe(stamp, scan.unused);
  detectKidnapping(scan, report, how.slipped);
  if (isLost()) {
    report.lost = true;
  } else if (!params_.read_only) {
    // Observed landmarks confirm the pose: only then a missed one is evidence of its absence.
    register_.addEvidence(scan.observed, sensor_.evidence(true));
    if (!scan.observed.empty()) {
      countDetections(scan);
      register_.addMisses(scan.missed, scan.observed, sensor_.evidence(false));
      register_.addEvidence(scan.relocated, sensor_.evidence(false));
    }
    initialize(stamp, scan.unknown, report);
    report.merged = register_.mergeDuplicates(scan.observed, params_.sensor.min_separation, report.keys);
    report.removed = register_.removeUnlikely();
  }
  return report;
}

void LandmarkSlam::compareWithMap(const ScanAssociation& scan, LandmarkReport& report) const {
  const auto is_unlikely = [&](size_t each) { return register_.isUnlikelyMiss(each, scan.observed); };
  report.missed = static_cast<int>(std::count_if(scan.missed.begin(), scan.missed.end(), is_unlikely));
  if (params_.read_only || report.missed > 0) report.unexpected = static_cast<int>(scan.unknown.size());
}

/// The area counts as explored if an observed landmark confirms the pose.
void LandmarkSlam::noteView(const ScanAssociation& scan, const Pose2& T_base_sensor) {
  register_.noteMisses(scan.missed, scan.observed);
  if (!scan.observed.empty()) explored_.look(filter().pose() * T_base_sensor, sensor_);
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

std::vector<ScanInterpretation> LandmarkSlam::interpretations(
    const std::vector<LabelledObservation>& observations, const Pose2& T_base_sensor, size_t most,
    Detects detects) {
  if (isLost()) return {local_.front().interpretations(observations, T_base_sensor, 1, detects).front()};
  const MapKnowledge knowledge{sensor_,   params_.association, candidates_, unused_,
                               explored_, unconfirmed_,        detects};
  return interpretScan(register_, knowledge, corrected(observations, T_base_sensor), T_base_sensor, most);
}

LandmarkSlam::ScanAssociation LandmarkSlam::groupByOutcome(
    const ScanInterpretation& how, const std::vector<LabelledObservation>& observations,
    LandmarkReport& report) const {
  report.keys.resize(observations.size());
  ScanAssociation scan;
  for (size_t i = 0; i < observations.size(); ++i) {
    const auto& [outcome, landmark] = how.outcomes[i];
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
      if (!observations[i].label.id) scan.unused.push_back(inMap(filter().pose(), observations[i]));
    }
  }
  return scan;
}

/// A landmark of which only the class is known would match all observations of its class.
bool LandmarkSlam::canInitialize(const LabelledObservation& seen) const {
  return seen.can_initialize &&
         largestDeviation(seen.observation.covariance.topLeftCorner<2, 2>()) < params_.sensor.max_range;
}

void LandmarkSlam::initialize(double stamp, const std::vector<LabelledObservation>& unknown,
                              LandmarkReport& report) {
  std::vector<LabelledObservation> first;
  for (const LabelledObservation& each : unknown) {
    const bool is_twin = each.label.id && countLabels(each.label, unknown) > 1;
    if (is_twin) ++report.ambiguous;
    if (canInitialize(each) && !is_twin) first.push_back(each);
  }
  std::vector<PositionObservation> in_map;
  for (const LabelledObservation& each : first) in_map.push_back(inMap(filter().pose(), each));
  const std::vector<bool> is_landmark = candidates_.observe(stamp, in_map);
  for (size_t i = 0; i < first.size(); ++i) {
    if (is_landmark[i]) register_.add(first[i]);
    ++(is_landmark[i] ? report.initialized : report.tentative);
  }
}

// ---- kidnapping and relocalization

void LandmarkSlam::detectKidnapping(const ScanAssociation& scan, const LandmarkReport& report, bool slipped) {
  KidnapDetector::Evidence evidence;
  for (const size_t landmark : scan.observed) evidence.observed.push_back(keys()[landmark]);
  for (const size_t landmark : scan.missed) evidence.missed.push_back(keys()[landmark]);
  evidence.unknown = static_cast<int>(scan.unknown.size());
  evidence.contradictions = report.rejected;
  evidence.slipped = slipped;
  evidence.is_complete = params_.read_only;
  evidence.next_key = register_.nextKey();
  evidence.miss_weight = sensor_.evidence(false) / usualMiss();
  kidnap_detector_.update(evidence);
  const bool is_consistent =
      kidnap_detector_.isConsistent() && kidnap_detector_.firstProvisional() == register_.nextKey();
  if (is_consistent) trusted_.reset(), matched_size_ = 0;
  if (!is_consistent && !trusted_)
    trusted_ = std::make_shared<const std::pair<LandmarkRegister, ExploredArea>>(register_, explored_);
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
  if (trusted_) std::tie(register_, explored_) = *trusted_;
  register_.removeFrom(first_provisional);
  setPose(pose, covariance);
  if (!labels().empty()) startLocalMap();
}

void LandmarkSlam::lose() {
  relocalize();
  if (!isLost()) startLocalMap();
}

void LandmarkSlam::startLocalMap() {
  LandmarkSlamParams params = params_;
  params.read_only = false;
  params.lost_after = 0;
  const double variance = 1e-6;  // square metres and radians: the local frame begins at the robot
  local_ = {LandmarkSlam(params, Pose2{}, variance * Matrix3d::Identity())};
  local_.front().noise_ = noise_;
}

/// Matches the local map in the robot frame: there, the landmarks observed last are precise, however far the
/// robot drove while it was lost.
LandmarkReport LandmarkSlam::observeLost(double stamp, const std::vector<LabelledObservation>& observations,
                                         const Pose2& T_base_sensor, const ScanInterpretation& how) {
  LandmarkReport report = local_.front().observe(stamp, observations, T_base_sensor, how);
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

void LandmarkSlam::observePose(const PoseEstimate2D& measured) {
  const Pose2 pose = filter().pose();
  const Matrix3d P = filter().covariance({}), gain = P * (P + measured.covariance).inverse();
  const Vector3d step = gain * difference(measured.pose, pose);
  const Pose2 corrected{pose.position + step.head<2>(), wrapped(pose.heading + step(2))};
  const Matrix3d rest = Matrix3d::Identity() - gain;
  register_.filter().setPose(corrected,
                             rest * P * rest.transpose() + gain * measured.covariance * gain.transpose());
}

void LandmarkSlam::setMap(const Pose2& T_map_base, const std::vector<Landmark2D>& landmarks,
                          const std::vector<LandmarkLabel>& labels, const MatrixXd& covariance) {
  register_.setMap(T_map_base, landmarks, labels, covariance);
  explored_ = {};
  clearHypotheses();
}

void LandmarkSlam::clearHypotheses() {
  candidates_.clear();
  unused_.clear();
  local_.clear();
  trusted_.reset();
  matched_size_ = 0;
  kidnap_detector_ = KidnapDetector(params_.lost_after);
  kidnap_detector_.confirm(register_.nextKey());
}

}  // namespace sextant
