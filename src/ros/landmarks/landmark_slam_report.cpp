// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/landmarks/landmark_slam_report.hpp"

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <cmath>
#include <cstdio>
#include <tuple>

namespace sextant {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kSilence = 5.0;  // seconds without messages until a warning
constexpr double kWrong = 2.0;    // times the stated standard deviation
constexpr const char* kOdometryRemedy = "raise ~rotation_from_rotation and the other noise parameters";
constexpr const char* kSensorRemedy = "the covariances that the detector publishes are too small";
constexpr size_t kNis = 50;  // scans
constexpr std::pair<PlaceUse, const char*> kPlaceUses[] = {
    {PlaceUse::unused, "images of an unknown place, or not used"},
    {PlaceUse::agrees, "images of the place of the pose"},
    {PlaceUse::contradicts, "images of another place"},
    {PlaceUse::relocalized, "images that relocalized the robot"},
};

/// Warning for a topic without recent messages; empty if there are some.
std::string silence(const std::string& what, const std::string& topic,
                    const std::optional<ros::SteadyTime>& last) {
  if (!last) return "no " + what + " on " + topic;
  const double seconds = (ros::SteadyTime::now() - *last).toSec();
  if (seconds < kSilence) return "";
  return "no " + what + " on " + topic + " for " + std::to_string(std::lround(seconds)) + " s";
}

std::string tenths(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f", seconds);
  return text;
}

}  // namespace

void LandmarkSlamReport::observations(const std::string& topic, Arrival arrival, double ahead, double lag) {
  if (arrival == Arrival::too_late) ++too_late_;
  if (arrival == Arrival::duplicate) ++duplicate_;
  if (arrival == Arrival::too_large)
    trouble_.report("observations too many",
                    topic + " has more observations than ~max_observations: the message is not used");
  if (arrival == Arrival::too_late && ahead < -lag)
    trouble_.report("observations too late", topic + " is stamped " + tenths(-ahead) +
                                                 " s before odometry: synchronize the clocks, or raise ~lag");
  if (arrival == Arrival::waiting && ahead > lag)
    trouble_.report("observations ahead",
                    topic + " is stamped " + tenths(ahead) +
                        " s after odometry: synchronize the clocks, or odometry is late");
}

void LandmarkSlamReport::applied(const LandmarkTimeline::Applied& applied, const ros::Time& now) {
  sources_.add(applied);
  if (applied.places) {
    ++places_[*applied.places];
    return;
  }
  const LandmarkReport& report = applied.report;
  totals_.associated += report.associated;
  totals_.initialized += report.initialized;
  totals_.ambiguous += report.ambiguous;
  totals_.rejected += report.rejected;
  totals_.merged += report.merged;
  totals_.removed += report.removed;
  if (report.nis_dof > 0) nis_.emplace_back(report.nis, report.nis_dof);
  if (nis_.size() > kNis) nis_.pop_front();
  latency_.published(ros::Time(applied.stamp), now);
  trouble_.succeeded();
}

void LandmarkSlamReport::fill(diagnostic_updater::DiagnosticStatusWrapper& status,
                              const LandmarkHypotheses& all, size_t waiting, const std::string& odometry,
                              const std::string& observations) {
  const LandmarkSlam& slam = all.best();
  const LandmarkFilter& filter = slam.filter();
  trouble_.fill(status);
  fillLevel(status, slam, odometry, observations);
  status.add("sources that agree with the pose", sources_.supporting());
  status.add("landmarks", slam.labels().size());
  status.add("candidates", slam.candidates());
  fillTotals(status, waiting);
  latency_.fill(status);
  status.add("covariance repairs", filter.repairs());
  status.add("hypotheses", all.size());
  status.addf("probability of the best hypothesis", "%.2f", all.probability());
  fillCalibration(status, filter);
  status.addf("noise of odometry over the stated one", "%.2f", std::sqrt(slam.noise().odometry()));
  status.addf("noise of observations over the stated one", "%.2f", std::sqrt(slam.noise().observations()));
}

void LandmarkSlamReport::fillCalibration(diagnostic_updater::DiagnosticStatusWrapper& status,
                                         const LandmarkFilter& filter) {
  const auto add = [&](const char* name, double value, double variance) {
    if (variance > 0) status.addf(name, "%.4f +- %.4f", value, std::sqrt(variance));
  };
  add("scale of odometry", filter.scale(), filter.scaleVariance());
  add("scale of odometry's angles", filter.turnScale(), filter.turnScaleVariance());
  add("clock offset of observations (s)", filter.clockOffset(), filter.clockVariance());
  add("bearing offset of observations (rad)", filter.bearing(), filter.bearingVariance());
}

void LandmarkSlamReport::fillLevel(diagnostic_updater::DiagnosticStatusWrapper& status,
                                   const LandmarkSlam& slam, const std::string& odometry,
                                   const std::string& observations) const {
  const std::string no_odometry = silence("odometry", odometry, odometry_received_),
                    no_observations = silence("observations", observations, observations_received_);
  for (const auto& [factor, what, remedy] : {std::tuple{slam.noise().odometry(), "odometry", kOdometryRemedy},
                                             {slam.noise().observations(), "observations", kSensorRemedy}})
    if (factor > kWrong * kWrong && status.level == DiagnosticStatus::OK)
      status.summaryf(DiagnosticStatus::WARN, "the noise of %s is %.1f times the stated one: %s", what,
                      std::sqrt(factor), remedy);
  for (const std::string& problem : sources_.problems())
    if (status.level == DiagnosticStatus::OK) status.summary(DiagnosticStatus::WARN, problem);
  if (slam.isLost())
    status.summary(DiagnosticStatus::WARN, "lost: no pose until enough landmarks of the map are observed");
  if (!no_observations.empty()) status.summary(DiagnosticStatus::WARN, no_observations);
  if (!no_odometry.empty()) status.summary(DiagnosticStatus::WARN, no_odometry);
}

void LandmarkSlamReport::fillTotals(diagnostic_updater::DiagnosticStatusWrapper& status,
                                    size_t waiting) const {
  status.add("observations associated", totals_.associated);
  status.add("observations ambiguous", totals_.ambiguous);
  status.add("observations rejected", totals_.rejected);
  status.add("landmarks initialized", totals_.initialized);
  status.add("landmarks merged", totals_.merged);
  status.add("landmarks removed", totals_.removed);
  status.add("scans too late", too_late_);
  status.add("scans duplicate", duplicate_);
  status.add("scans waiting", waiting);
  for (const auto& [use, name] : kPlaceUses)
    if (!places_.empty()) status.add(name, places_.count(use) ? places_.at(use) : 0);
  double nis = 0;
  int width = 0;
  for (const auto& [value, degrees] : nis_) nis += value, width += degrees;
  if (width > 0) status.addf("NIS per degree of freedom", "%.2f", nis / width);
}

}  // namespace sextant
