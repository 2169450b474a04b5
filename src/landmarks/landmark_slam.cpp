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

constexpr double kDeviations = 3.0;  // that a robot may be off
constexpr size_t kFresh = 4;         // loose landmarks that may tell that they are others
constexpr size_t kMostLoose = 12;    // that are taken to be new ones, where none is another
constexpr double kElsewhere = 1.0;   // metres and
constexpr double kTurned = 0.35;     // radians that a robot is off that is not where it thinks
constexpr int kLooks = 10;  // after which a lost robot seeks itself again, if it has found nothing new

bool contains(const std::vector<size_t>& all, size_t one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

long countOf(const LandmarkLabel& label, const std::vector<LabelledSighting>& sightings) {
  return std::count_if(sightings.begin(), sightings.end(),
                       [&](const auto& each) { return each.label == label; });
}

}  // namespace

ParamList LandmarkSlamParams::fields() {
  const ParamList own = {
      {"read_only", &read_only, Allowed(), "", "no landmark comes or goes"},
      {"lost_after", &lost_after, Range::closed(0, 10000), "",
       "moments in a row in which nothing is where it should be, after which the robot is lost; 0: it never "
       "is"},
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
      watch_(params.lost_after) {
  validate(params);
}

void LandmarkSlam::predict(const OdometryStep& step, double duration) {
  register_.filter().predict(step, duration);
  for (LandmarkSlam& local : local_) local.predict(step, duration);
}

LandmarkReport LandmarkSlam::see(double stamp, const std::vector<LabelledSighting>& sightings,
                                 const Pose2& T_base_sensor) {
  return isLost() ? seeLost(stamp, sightings, T_base_sensor) : seeKnown(stamp, sightings, T_base_sensor);
}

LandmarkReport LandmarkSlam::seeKnown(double stamp, const std::vector<LabelledSighting>& sightings,
                                      const Pose2& T_base_sensor) {
  const std::vector<size_t> near = inReach(sightings);
  LandmarkReport report;
  const Sorted sorted = this->sorted(near, sightings, T_base_sensor, report);
  register_.filter().update(sorted.known);
  if (report.known > 0) report.nis = filter().nis(), report.nis_width = filter().nisWidth();
  watch(sorted, report);
  if (isLost()) {
    report.lost = true;
  } else if (!params_.read_only) {
    // Others show that the robot is where it should be: what is missed is not there.
    register_.judge(sorted.seen, sensor_.evidence(true));
    if (!sorted.seen.empty()) {
      register_.judge(sorted.missed, sensor_.evidence(false));
      register_.judge(sorted.elsewhere, sensor_.evidence(false));
    }
    begin(stamp, sorted.unknown, report);
    report.merged = register_.mergeSame(sorted.seen, params_.sensor.separation, report.keys);
    report.removed = register_.removeDoubted();
  }
  return report;
}

// ---- what sightings are of

/// Landmarks that may be seen from where the robot may be, and that the sightings may be of.
std::vector<size_t> LandmarkSlam::inReach(const std::vector<LabelledSighting>& sightings) const {
  const double off = kDeviations * largestDeviation(filter().covariance({}).topLeftCorner<2, 2>());
  const auto may_be = [off](const LabelledSighting& each, double range) {
    const double deviation = largestDeviation(each.sighting.covariance.topLeftCorner<2, 2>());
    return std::abs(each.sighting.position.norm() - range) < 2 * kDeviations * deviation + off;
  };
  const auto& landmarks = filter().landmarks();
  std::vector<size_t> found;
  for (size_t i = 0; i < landmarks.size(); ++i) {
    const double range = (landmarks[i].position - filter().pose().position).norm();
    if (range < params_.sensor.max_range + off ||
        std::any_of(sightings.begin(), sightings.end(),
                    [&](const auto& each) { return may_be(each, range); }))
      found.push_back(i);
  }
  return found;
}

LandmarkSlam::Sorted LandmarkSlam::sorted(const std::vector<size_t>& near,
                                          const std::vector<LabelledSighting>& sightings,
                                          const Pose2& T_base_sensor, LandmarkReport& report) {
  const SightingPrediction expected = register_.filter().predicted(near);
  Sorted sorted = byOrigin(associated(near, expected, sightings), sightings, report);
  // A print is seen from its front only: that it is not seen says nothing, that it is seen elsewhere does.
  for (const size_t which : sensor_.surelyInView(expected, T_base_sensor))
    if (!labels()[near[which]].id && !contains(sorted.seen, near[which]))
      sorted.missed.push_back(near[which]);
  return sorted;
}

LandmarkSlam::Sorted LandmarkSlam::byOrigin(const std::vector<Association>& origins,
                                            const std::vector<LabelledSighting>& sightings,
                                            LandmarkReport& report) const {
  report.keys.resize(sightings.size());
  Sorted sorted;
  for (size_t i = 0; i < sightings.size(); ++i) {
    const auto& [origin, landmark] = origins[i];
    const bool is_twin = origin == Origin::known && contains(sorted.seen, landmark);  // one id, seen twice
    if (origin == Origin::known && !is_twin) {
      sorted.known.push_back({landmark, sightings[i].sighting});
      sorted.seen.push_back(landmark);
      report.keys[i] = keys()[landmark];
      ++report.known;
    } else if (origin == Origin::unknown) {
      sorted.unknown.push_back(sightings[i]);
    } else if (sightings[i].label.id && !is_twin) {
      ++report.rejected;
      sorted.elsewhere.push_back(landmark);
    } else {
      ++report.doubtful;
    }
  }
  return sorted;
}

std::vector<Association> LandmarkSlam::associated(const std::vector<size_t>& near,
                                                  const SightingPrediction& expected,
                                                  const std::vector<LabelledSighting>& sightings) {
  std::vector<LandmarkPoint> points;
  for (size_t k = 0; k < near.size(); ++k)
    points.push_back({expected.positions.segment<2>(2 * k), labels()[near[k]]});
  std::vector<LandmarkPointSighting> seen;
  for (const LabelledSighting& each : sightings)
    if (!each.label.id)
      seen.push_back({each.sighting.position, each.sighting.covariance.topLeftCorner<2, 2>(), each.label});
  const std::vector<Association> of_seen = associate(points, expected.covariance, seen, params_.association);

  std::vector<Association> found;
  for (size_t i = 0, k = 0; i < sightings.size(); ++i) {
    found.push_back(sightings[i].label.id ? associatedById(sightings[i]) : of_seen[k++]);
    if (!sightings[i].label.id && found[i].origin == Origin::known)
      found[i].landmark = near[found[i].landmark];
  }
  return found;
}

/// Measured ids are known, but where the landmark is surely elsewhere.
Association LandmarkSlam::associatedById(const LabelledSighting& sighting) {
  const auto which = register_.find(sighting.label);
  if (!which) return {};
  const PlaneLandmark& landmark = filter().landmarks()[*which];
  const bool heading = commonWidth(sighting.sighting, landmark) == 3;
  const std::vector<KnownSighting> seen{{*which, sighting.sighting}};
  const Eigen::VectorXd off = differences(seen, {seenFrom(filter().pose(), landmark)});
  const MatrixXd S =
      register_.filter().predicted({*which}, heading).covariance + noiseOf(seen, filter().landmarks());
  const double gate =
      quantile(boost::math::chi_squared(static_cast<double>(off.size())), params_.association.doubt);
  return {off.dot(S.llt().solve(off)) < gate ? Origin::known : Origin::doubtful, *which};
}

void LandmarkSlam::begin(double stamp, const std::vector<LabelledSighting>& unknown, LandmarkReport& report) {
  const Matrix2d R = rotation2(filter().pose().heading);
  std::vector<LabelledSighting> first;
  for (const LabelledSighting& each : unknown) {
    const bool is_twin = each.label.id && countOf(each.label, unknown) > 1;
    if (is_twin) ++report.doubtful;
    if (each.begins && !is_twin) first.push_back(each);
  }
  std::vector<LandmarkPointSighting> in_map;
  for (const LabelledSighting& each : first)
    in_map.push_back({filter().pose() * each.sighting.position,
                      R * each.sighting.covariance.topLeftCorner<2, 2>() * R.transpose(), each.label});
  const std::vector<bool> is_landmark = candidates_.see(stamp, in_map);
  for (size_t i = 0; i < first.size(); ++i) {
    if (is_landmark[i]) register_.add(first[i]);
    ++(is_landmark[i] ? report.begun : report.waiting);
  }
}

// ---- where the robot may be elsewhere than it thinks

void LandmarkSlam::watch(const Sorted& sorted, const LandmarkReport& report) {
  LostWatch::Look look;
  for (const size_t landmark : sorted.seen) look.seen.push_back(keys()[landmark]);
  for (const size_t landmark : sorted.missed) look.missed.push_back(keys()[landmark]);
  look.unknown = static_cast<int>(sorted.unknown.size());
  look.strangers = report.rejected + (params_.read_only ? look.unknown / 2 : 0);  // one may be of nothing
  look.next_key = register_.nextKey();
  watch_.look(look);
  const bool is_well = watch_.isCalm() && watch_.firstLoose() == register_.nextKey();
  if (is_well) trusted_.reset(), fresh_ = 0;
  if (!is_well && !trusted_) trusted_ = std::make_shared<const LandmarkRegister>(register_);
  if (watch_.isLost() || isElsewhere()) lose();
}

/// Whether what is loose lies in the map of what was there before, but elsewhere.
bool LandmarkSlam::isElsewhere() {
  std::vector<MapPoint> loose, old;
  const std::vector<MapPoint> all = register_.points();
  for (size_t i = 0; i < all.size(); ++i) (keys()[i] < watch_.firstLoose() ? old : loose).push_back(all[i]);
  if (params_.lost_after < 1 || loose.size() < kFresh || loose.size() == fresh_) return false;
  fresh_ = loose.size();
  const auto match = matchLandmarks(loose, old, params_.matching);
  if (!match && loose.size() >= kMostLoose) watch_.join(register_.nextKey());
  if (!match) return false;
  const Pose2 there = match->T_map_local * filter().pose();
  return (there.position - filter().pose().position).norm() > kElsewhere ||
         std::abs(wrapped(match->T_map_local.heading)) > kTurned;
}

void LandmarkSlam::lose() {
  const Pose2 pose = filter().pose();
  const Matrix3d covariance = filter().covariance({});
  const int first_loose = watch_.firstLoose();
  if (trusted_) register_ = *trusted_;
  register_.removeFrom(first_loose);
  setPose(pose, covariance);
  if (labels().empty()) return;
  LandmarkSlamParams params = params_;
  params.read_only = false;
  params.lost_after = 0;
  const double exact = 1e-6;
  local_ = {LandmarkSlam(params, Pose2{}, exact * Matrix3d::Identity())};
}

LandmarkReport LandmarkSlam::seeLost(double stamp, const std::vector<LabelledSighting>& sightings,
                                     const Pose2& T_base_sensor) {
  LandmarkReport report = local_.front().see(stamp, sightings, T_base_sensor);
  std::fill(report.keys.begin(), report.keys.end(), std::nullopt);
  report.waiting = static_cast<int>(sightings.size());
  report.known = report.doubtful = report.nis_width = 0;
  if (report.begun > 0 || ++looks_ % kLooks == 0)
    if (const auto match =
            matchLandmarks(local_.front().register_.points(), register_.points(), params_.matching))
      join(*match);
  report.begun = 0;
  report.lost = isLost();
  return report;
}

/// The robot is where it sees the landmarks of its own map in the other one; all that is not known of that is
/// told to the filter at once.
void LandmarkSlam::join(const LandmarkMatch& match) {
  std::vector<size_t> of_local;
  bool headings = true;  // all of them have one, in both maps
  for (const auto& [own, of_map] : match.pairs) {
    of_local.push_back(own);
    headings =
        headings && local_.front().filter().landmarks()[own].heading && filter().landmarks()[of_map].heading;
  }
  const SightingPrediction seen = local_.front().register_.filter().predicted(of_local, headings);
  std::vector<KnownSighting> sightings;
  Eigen::Index at = 0;
  for (const auto& pair : match.pairs) {
    PlaneSighting sighting{seen.positions.segment<2>(at), {}, Matrix3d::Zero()};
    at += 2;
    if (headings) sighting.heading = seen.positions(at++);
    sightings.push_back({pair.second, sighting});
  }
  const Vector3d around(0.5, 0.5, 0.3);  // metres and radians: far more than the match may be off
  setPose(match.T_map_local * local_.front().filter().pose(), around.cwiseAbs2().asDiagonal());
  register_.filter().update(sightings, seen.covariance);
}

void LandmarkSlam::setPose(const Pose2& T_map_base, const Matrix3d& covariance) {
  register_.filter().setPose(T_map_base, covariance);
  beginAnew();
}

void LandmarkSlam::setMap(const Pose2& T_map_base, const std::vector<PlaneLandmark>& landmarks,
                          const std::vector<LandmarkLabel>& labels, const MatrixXd& covariance) {
  register_.setMap(T_map_base, landmarks, labels, covariance);
  beginAnew();
}

void LandmarkSlam::beginAnew() {
  candidates_.clear();
  local_.clear();
  trusted_.reset();
  fresh_ = 0;
  watch_ = LostWatch(params_.lost_after);
  watch_.join(register_.nextKey());
}

}  // namespace sextant
