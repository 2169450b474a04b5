// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
// LandmarkSlam where the robot may be elsewhere than it thinks.
#include <algorithm>
#include <cmath>

#include "sextant/landmarks/landmark_slam.hpp"

namespace sextant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr size_t kFresh = 4;        // loose landmarks that may tell that they are others
constexpr size_t kMostLoose = 12;   // that are taken to be new ones, where none is another
constexpr double kElsewhere = 1.0;  // metres and
constexpr double kTurned = 0.35;    // radians that a robot is off that is not where it thinks
constexpr int kLooks = 10;  // after which a lost robot seeks itself again, if it has found nothing new

}  // namespace

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
