// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_timeline.hpp"

#include <algorithm>

namespace sextant {
namespace {

constexpr double kSettled = 1.5;  // lags after which a time without sightings is gone through
constexpr size_t kMostWaiting = 100;
constexpr double kLeap = 1.0, kFastest = 20.0;  // m and m/s
constexpr double kKept = 4;                     // states in a lag: a large map's takes 32 MB

}  // namespace

ParamList LandmarkTimelineParams::fields() {
  const ParamList own = {
      {"lag", &lag, Range::openLow(0, 60), "s", "how late sightings may come"},
      {"clock_offset", &clock_offset, Range::closed(-10, 10), "s", "that is added to the sightings' stamps"},
  };
  return joined({odometry.fields(), own});
}

LandmarkTimeline::LandmarkTimeline(const LandmarkTimelineParams& params, const LandmarkSlam& slam)
    : params_(params), history_(params.odometry, 2 * kSettled * params.lag), base_{0, slam} {
  validate(params);
}

bool LandmarkTimeline::odometry(double stamp, const Pose2& T_odom_base) {
  applied_.clear();
  if (isLeap(stamp, T_odom_base)) beginElsewhere();
  if (history_.empty()) base_.stamp = stamp;
  if (!history_.add(stamp, T_odom_base)) return false;
  const auto end = std::find_if(waiting_.begin(), waiting_.end(),
                                [&](const Moment& moment) { return moment.stamp > stamp; });
  const std::vector<Moment> ready(std::make_move_iterator(waiting_.begin()), std::make_move_iterator(end));
  waiting_.erase(waiting_.begin(), end);
  for (const Moment& moment : ready) apply(moment);
  settle();
  return true;
}

Arrival LandmarkTimeline::see(double stamp, const std::vector<LabelledSighting>& sightings,
                              const Pose2& T_base_sensor) {
  const double moment = stamp + params_.clock_offset + newest().slam.filter().clockOffset();
  const auto is_same = [&](const Moment& other) {
    return other.heard == stamp && other.T_base_sensor == T_base_sensor && other.sightings == sightings;
  };
  applied_.clear();
  if (std::any_of(moments_.begin(), moments_.end(), is_same) ||
      std::any_of(waiting_.begin(), waiting_.end(), is_same))
    return Arrival::duplicate;
  if (history_.empty() || moment > history_.last()) {
    wait({moment, stamp, sightings, T_base_sensor});
    return Arrival::waiting;
  }
  if (moment < std::max(base_.stamp, history_.last() - params_.lag)) return Arrival::too_late;
  apply({moment, stamp, sightings, T_base_sensor});
  return Arrival::taken;
}

/// By stamp. Of too many those that would wait the longest are dropped.
void LandmarkTimeline::wait(const Moment& moment) {
  waiting_.insert(std::upper_bound(waiting_.begin(), waiting_.end(), moment, isBefore), moment);
  if (waiting_.size() > kMostWaiting) waiting_.pop_back();
}

/// Whether nothing drives so far so fast: odometry began anew, or somebody put the robot elsewhere.
bool LandmarkTimeline::isLeap(double stamp, const Pose2& T_odom_base) const {
  if (history_.empty() || stamp <= history_.last()) return false;
  const double way = (T_odom_base.position - history_.at(history_.last())->position).norm();
  return way > kLeap && way > kFastest * (stamp - history_.last());
}

/// Where is not known.
void LandmarkTimeline::beginElsewhere() {
  ++leaps_;
  restart();
  base_.slam.lose();
}

/// At its place among the others; those after it are gone through again.
void LandmarkTimeline::apply(Moment moment) {
  if (moment.stamp < base_.stamp) return;
  const auto at = std::upper_bound(moments_.begin(), moments_.end(), moment, isBefore);
  auto each = afterKnown(moments_.insert(at, std::move(moment)));
  State state = takenBefore(each);
  for (; each != moments_.end(); ++each) {
    state = advanced(std::move(state), each->stamp);
    const LandmarkReport report = state.slam.see(each->stamp, each->sightings, each->T_base_sensor);
    if (!each->is_told) applied_.push_back({each->heard, report});
    each->is_told = true;
    each->after.reset();
    if (isKept(each) && std::next(each) != moments_.end()) each->after = state;
  }
  moments_.back().after = std::move(state);
}

/// Of the last moment, but where going through the moments threw.
const LandmarkTimeline::State& LandmarkTimeline::newest() const {
  const auto known = std::find_if(moments_.rbegin(), moments_.rend(),
                                  [](const Moment& each) { return each.after.has_value(); });
  return known == moments_.rend() ? base_ : *known->after;
}

/// The first moment from which on to go through all before this one: what was before it is known.
LandmarkTimeline::Moments::iterator LandmarkTimeline::afterKnown(Moments::iterator each) {
  while (each != moments_.begin() && !std::prev(each)->after) --each;
  return each;
}

/// Whether what was after a moment is kept when another one comes.
bool LandmarkTimeline::isKept(Moments::iterator each) {
  const auto first = afterKnown(each);
  const double known = first == moments_.begin() ? base_.stamp : std::prev(first)->stamp;
  return each->stamp - known >= params_.lag / kKept;
}

LandmarkTimeline::State LandmarkTimeline::takenBefore(Moments::iterator each) {
  if (each == moments_.begin()) return base_;
  std::optional<State>& known = std::prev(each)->after;
  if (isKept(std::prev(each))) return *known;
  State state = std::move(*known);
  known.reset();
  return state;
}

LandmarkTimeline::State LandmarkTimeline::advanced(State state, double stamp) const {
  if (stamp <= state.stamp) return state;
  if (const auto step = history_.between(state.stamp, stamp)) state.slam.predict(*step, stamp - state.stamp);
  state.stamp = stamp;
  return state;
}

/// Moments that nothing can come before any more are done with.
void LandmarkTimeline::settle() {
  const double until = history_.last() - params_.lag;
  const auto done =
      afterKnown(std::lower_bound(moments_.begin(), moments_.end(), until,
                                  [](const Moment& moment, double stamp) { return moment.stamp < stamp; }));
  if (done != moments_.begin()) {
    base_ = std::move(*std::prev(done)->after);
    moments_.erase(moments_.begin(), done);
  }
  if (base_.stamp < history_.last() - kSettled * params_.lag && moments_.empty())
    base_ = advanced(base_, until);
}

std::optional<LandmarkTimeline::Now> LandmarkTimeline::now() const {
  if (history_.empty()) return {};
  const auto T_odom_base = history_.at(history_.last());
  const auto step = history_.between(newest().stamp, history_.last());
  if (!step) return {};
  const PlanePoseEstimate ahead = newest().slam.filter().ahead(*step);
  return Now{history_.last(), ahead.pose, ahead.covariance, ahead.pose * T_odom_base->inverse()};
}

void LandmarkTimeline::begin(const State& state) {
  base_ = state;
  moments_.clear();
  waiting_.clear();
  applied_.clear();
}

void LandmarkTimeline::restart() {
  begin(newest());
  history_.clear();
}

}  // namespace sextant
