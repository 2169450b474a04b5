// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_slam.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "sextant/base/range.hpp"

namespace sextant {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

constexpr double kDeviations = 3.0;  // that a robot may be off

bool contains(const std::vector<size_t>& all, size_t one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

long countOf(const LandmarkLabel& label, const std::vector<LabelledSighting>& sightings) {
  return std::count_if(sightings.begin(), sightings.end(),
                       [&](const auto& each) { return each.label == label; });
}

}  // namespace

void LandmarkSlamParams::validate() const {
  filter.validate();
  association.validate();
  candidates.validate();
  sensor.validate();
  matching.validate();
  Range::closed(0, 10000).require("lost_after", lost_after);
}

LandmarkSlam::LandmarkSlam(const LandmarkSlamParams& params, const Pose2& T_map_base,
                           const Matrix3d& covariance)
    : params_(params),
      sensor_(params.sensor),
      register_(params.filter, T_map_base, covariance),
      candidates_(params.candidates),
      watch_(params.lost_after) {
  params.validate();
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
  std::vector<LandmarkCandidates::Sighting> in_map;
  for (const LabelledSighting& each : first)
    in_map.push_back({filter().pose() * each.sighting.position,
                      R * each.sighting.covariance.topLeftCorner<2, 2>() * R.transpose(), each.label});
  const std::vector<bool> is_landmark = candidates_.see(stamp, in_map);
  for (size_t i = 0; i < first.size(); ++i) {
    if (is_landmark[i]) register_.add(first[i]);
    ++(is_landmark[i] ? report.begun : report.waiting);
  }
}

}  // namespace sextant
