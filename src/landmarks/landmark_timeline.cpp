// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_timeline.hpp"

#include <algorithm>

namespace sextant {
namespace {

constexpr double kSettled = 1.5;  // lags without scans after which the state is predicted
constexpr size_t kMaxWaiting = 100;
constexpr double kJump = 1.0, kMaxSpeed = 20.0;  // m and m/s
constexpr double kStatesPerLag = 4;              // stored states per lag: one of a large map takes 32 MB

}  // namespace

ParamList LandmarkTimelineParams::fields() {
  const ParamList own = {
      {"lag", &lag, Range::openLow(0, 60), "s", "maximum delay of observations; later ones are dropped"},
      {"clock_offset", &clock_offset, Range::closed(-10, 10), "s",
       "offset that is added to the stamps of observations"},
      {"max_observations", &max_observations, Range::closed(1, 10000), "",
       "maximum number of observations in a scan; a scan with more is not used: the time for one grows with "
       "the cube of their number and more"},
  };
  return joined({odometry.fields(), own});
}

LandmarkTimeline::LandmarkTimeline(const LandmarkTimelineParams& params, const LandmarkSlam& slam)
    : params_(params),
      history_(params.odometry, 2 * kSettled * params.lag),
      base_{0, LandmarkHypotheses(slam)} {
  validate(params);
}

bool LandmarkTimeline::odometry(double stamp, const Pose2& T_odom_base) {
  applied_.clear();
  if (isJump(stamp, T_odom_base)) restartLost();
  if (history_.empty()) base_.stamp = stamp;
  if (!history_.add(stamp, T_odom_base)) return false;
  const auto end =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const Scan& scan) { return scan.stamp > stamp; });
  const std::vector<Scan> ready(std::make_move_iterator(waiting_.begin()), std::make_move_iterator(end));
  waiting_.erase(waiting_.begin(), end);
  for (const Scan& scan : ready) apply(scan);
  removeSettled();
  return true;
}

Arrival LandmarkTimeline::observe(double stamp, const std::vector<LabelledObservation>& observations,
                                  const Pose2& T_base_sensor, Detects detects) {
  applied_.clear();
  if (observations.size() > static_cast<size_t>(params_.max_observations)) return Arrival::too_large;
  const double corrected = stamp + params_.clock_offset + slam().filter().clockOffset();
  const auto is_same = [&](const Scan& other) {
    return !other.places && other.received_stamp == stamp && other.T_base_sensor == T_base_sensor &&
           other.observations == observations;
  };
  if (std::any_of(scans_.begin(), scans_.end(), is_same) ||
      std::any_of(waiting_.begin(), waiting_.end(), is_same))
    return Arrival::duplicate;
  return add({corrected, stamp, observations, T_base_sensor, detects});
}

Arrival LandmarkTimeline::observePlaces(double stamp, const std::vector<PossiblePose>& poses) {
  applied_.clear();
  return add({stamp, stamp, {}, {}, {}, poses});
}

/// Applies it, or lets it wait for odometry.
Arrival LandmarkTimeline::add(const Scan& scan) {
  if (history_.empty() || scan.stamp > history_.last()) {
    wait(scan);
    return Arrival::waiting;
  }
  if (scan.stamp < std::max(base_.stamp, history_.last() - params_.lag)) return Arrival::too_late;
  apply(scan);
  return Arrival::applied;
}

/// Inserts by stamp; drops the newest one if there are too many.
void LandmarkTimeline::wait(const Scan& scan) {
  waiting_.insert(std::upper_bound(waiting_.begin(), waiting_.end(), scan, isBefore), scan);
  if (waiting_.size() > kMaxWaiting) waiting_.pop_back();
}

/// Whether no robot drives this far this fast: odometry restarted, or the robot was carried.
bool LandmarkTimeline::isJump(double stamp, const Pose2& T_odom_base) const {
  if (history_.empty() || stamp <= history_.last()) return false;
  const double distance = (T_odom_base.position - history_.at(history_.last())->position).norm();
  return distance > kJump && distance > kMaxSpeed * (stamp - history_.last());
}

/// Restarts odometry at an unknown pose.
void LandmarkTimeline::restartLost() {
  ++jumps_;
  restart();
  base_.hypotheses.settled().relocalize();
}

/// Inserts a scan by stamp, and applies it and all later ones.
void LandmarkTimeline::apply(Scan added) {
  if (added.stamp < base_.stamp) return;
  const auto at = std::upper_bound(scans_.begin(), scans_.end(), added, isBefore);
  auto scan = firstToReplay(scans_.insert(at, std::move(added)));
  State state = stateBefore(scan);
  for (; scan != scans_.end(); ++scan) {
    state = advanced(std::move(state), scan->stamp);
    Applied applied = applyTo(state, *scan);
    if (!scan->is_reported) {
      applied.wrong = state.hypotheses.wrongSources();
      applied_.push_back(std::move(applied));
    }
    scan->is_reported = true;
    scan->after.reset();
    if (isKept(scan) && std::next(scan) != scans_.end()) scan->after = state;
  }
  scans_.back().after = std::move(state);
}

LandmarkTimeline::Applied LandmarkTimeline::applyTo(State& state, const Scan& scan) {
  if (scan.places)
    return {scan.received_stamp, scan.detects, {}, state.hypotheses.observePlaces(*scan.places)};
  return {scan.received_stamp,
          scan.detects,
          state.hypotheses.observe(scan.stamp, scan.observations, scan.T_base_sensor, scan.detects),
          {}};
}

/// State after the newest scan that has one: replaying may have thrown before the end.
const LandmarkTimeline::State& LandmarkTimeline::newest() const {
  const auto known =
      std::find_if(scans_.rbegin(), scans_.rend(), [](const Scan& scan) { return scan.after.has_value(); });
  return known == scans_.rend() ? base_ : *known->after;
}

/// First scan to replay up to this one: the state before it is stored.
LandmarkTimeline::Scans::iterator LandmarkTimeline::firstToReplay(Scans::iterator scan) {
  while (scan != scans_.begin() && !std::prev(scan)->after) --scan;
  return scan;
}

/// Whether the state after a scan stays stored when the next one is applied.
bool LandmarkTimeline::isKept(Scans::iterator scan) {
  const auto first = firstToReplay(scan);
  const double known = first == scans_.begin() ? base_.stamp : std::prev(first)->stamp;
  return scan->stamp - known >= params_.lag / kStatesPerLag;
}

LandmarkTimeline::State LandmarkTimeline::stateBefore(Scans::iterator scan) {
  if (scan == scans_.begin()) return base_;
  std::optional<State>& known = std::prev(scan)->after;
  if (isKept(std::prev(scan))) return *known;
  State state = std::move(*known);
  known.reset();
  return state;
}

LandmarkTimeline::State LandmarkTimeline::advanced(State state, double stamp) const {
  if (stamp <= state.stamp) return state;
  if (const auto step = history_.between(state.stamp, stamp))
    state.hypotheses.predict(*step, stamp - state.stamp);
  state.stamp = stamp;
  return state;
}

/// Removes the scans before which no other one can be inserted any more.
void LandmarkTimeline::removeSettled() {
  const double until = history_.last() - params_.lag;
  const auto done =
      firstToReplay(std::lower_bound(scans_.begin(), scans_.end(), until,
                                     [](const Scan& scan, double stamp) { return scan.stamp < stamp; }));
  if (done != scans_.begin()) {
    base_ = std::move(*std::prev(done)->after);
    scans_.erase(scans_.begin(), done);
  }
  if (base_.stamp < history_.last() - kSettled * params_.lag && scans_.empty())
    base_ = advanced(base_, until);
}

std::optional<LandmarkTimeline::Now> LandmarkTimeline::now() const {
  if (history_.empty()) return {};
  const auto T_odom_base = history_.at(history_.last());
  const auto step = history_.between(newest().stamp, history_.last());
  if (!step) return {};
  const PoseEstimate2D predicted = hypotheses().predictPose(*step);
  return Now{history_.last(), predicted.pose, predicted.covariance, predicted.pose * T_odom_base->inverse()};
}

void LandmarkTimeline::reset(const State& state) {
  base_ = state;
  scans_.clear();
  waiting_.clear();
  applied_.clear();
}

void LandmarkTimeline::restart() {
  reset(newest());
  history_.clear();
}

}  // namespace sextant
