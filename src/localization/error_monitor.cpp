// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/error_monitor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

constexpr int kFirstPeriod = 20, kLastPeriod = 100;  // images between two evaluations
constexpr double kMemory = 500.0;                    // images after which an image has the weight 1/e
constexpr double kMinCount = 100.0;                  // residuals before a cause is accepted
constexpr double kMinForMoved = 30.0;                // residuals before a moved marker is found
constexpr size_t kMaxMarkers = 30;  // that are monitored: the time of an evaluation is cubic in their number
constexpr size_t kExactMoved = 3;   // moved markers whose evidence is computed without approximation
constexpr int kMaxReplays = 6;      // without further images

// Differences of the logarithm of the evidence.
constexpr double kMinGain = 20.0;        // to accept a cause
constexpr double kMinMargin = 5.0;       // of a moved marker over all other explanations
constexpr double kMinAdvantage = 0.1;    // over the next marker: of its gain, whose linear model is not exact
constexpr double kNonlinearity = 0.001;  // of the misfit: what the linear model of a moved marker leaves
constexpr double kMaxLoss = 3.0;         // to drop an accepted cause
constexpr double kMinShare = 0.2;        // of the misfit that an accepted cause explains
constexpr double kMinVariance = 1e-14;   // of a prior

// Prior standard deviations.
constexpr double kFocal = 0.02, kCentre = 15, kDistortion = 0.1, kReadout = 0.03, kSize = 0.02;
const Eigen::Vector2d kMoved(0.1, 0.3);              // metres and radians
const Eigen::Vector2d kMinMoved(0.02, 0.06);         // smaller errors are normal for maps
const Eigen::Vector2d kExactMap(0.0001, 0.0004);     // of a map without declared errors: metres and radians
const std::array<Eigen::Vector2d, 4> kMapSigmas = {  // tried for the map
    Eigen::Vector2d(0.0005, 0.001), Eigen::Vector2d(0.002, 0.004), Eigen::Vector2d(0.01, 0.015),
    Eigen::Vector2d(0.03, 0.04)};

Vector6d variancesOf(const Eigen::Vector2d& sigmas) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigmas[0] * sigmas[0]),
      Eigen::Vector3d::Constant(sigmas[1] * sigmas[1]);
  return variances;
}

Matrix6d diagonal(const Eigen::Vector2d& sigmas) { return variancesOf(sigmas).asDiagonal(); }

std::vector<Eigen::Index> sixFrom(Eigen::Index first) {
  return {first, first + 1, first + 2, first + 3, first + 4, first + 5};
}

// Columns of a cause among those of its camera, and their standard deviation.
struct Columns {
  Eigen::Index first, count;
  double sigma;
};

Columns columnsOf(ErrorCause kind) {
  switch (kind) {
    case ErrorCause::focal_length:
      return {0, 1, kFocal};
    case ErrorCause::centre:
      return {1, 2, kCentre};
    case ErrorCause::distortion:
      return {3, 1, kDistortion};
    case ErrorCause::shutter:
      return {4, 1, kReadout};
    case ErrorCause::marker_size:
      return {0, 1, kSize};
    case ErrorCause::map:
      break;
  }
  return {0, 0, 0};
}

bool contains(const std::vector<Eigen::Index>& columns, Eigen::Index column) {
  return std::find(columns.begin(), columns.end(), column) != columns.end();
}

// The prior, with the other ones of these columns certainly zero.
ErrorPrior withZero(ErrorPrior prior, const std::vector<Eigen::Index>& columns) {
  std::vector<Eigen::Index> zero;
  for (const Eigen::Index column : columns)
    if (!contains(prior.columns, column)) zero.push_back(column);
  prior.add(zero, Eigen::VectorXd::Constant(static_cast<Eigen::Index>(zero.size()), kMinVariance));
  return prior;
}

}  // namespace

void ErrorMonitor::add(const std::vector<MonitoredMarker>& markers, double weight) {
  if (markers.size() < 2) return;
  for (const MonitoredMarker& marker : markers) map_covariances_[marker.key] = marker.map_covariance;
  sums_.add(markers, weight);
  if (++images_ < std::max(next_, kFirstPeriod)) return;
  replays_ = 0;
  evaluate();
}

void ErrorMonitor::evaluate() {
  next_ = images_ + std::clamp(images_ / 2, kFirstPeriod, kLastPeriod);
  if (sums_.count() < kMinForMoved) return;
  sums_.keepMarkers(kMaxMarkers);
  bool changed = false;
  while (findMoved()) changed = true;
  changed |= sums_.count() >= kMinCount && accept();
  while (dropOne()) changed = true;
  apply(modelOf(accepted_, map_sigmas_));
  sums_.fade(std::exp((evaluated_ - images_) / kMemory));
  evaluated_ = images_;
  needs_replay_ = changed && replays_ < kMaxReplays;
}

void ErrorMonitor::beginReplay() {
  sums_.clear();
  needs_replay_ = false;
  ++replays_;
  next_ = std::numeric_limits<int>::max();  // until evaluate()
}

// ---- models ---------------------------------------------------------------------------------------------

// The causes that are not accepted, and all errors of each lens together: one of them alone may be taken for
// another one.
std::vector<std::vector<ErrorMonitor::Cause>> ErrorMonitor::candidates(
    const std::vector<Cause>& accepted) const {
  std::vector<std::vector<Cause>> all;
  const auto add = [&](const Cause& cause) {
    const bool is_new = std::none_of(accepted.begin(), accepted.end(), [&](const Cause& other) {
      return cause.kind == other.kind && cause.camera == other.camera;
    });
    if (is_new) all.push_back({cause});
    return is_new;
  };
  add({ErrorCause::marker_size});
  add({ErrorCause::map});
  for (size_t camera = 0; camera < sums_.cameras().size(); ++camera) {
    std::vector<Cause> lens;
    for (const ErrorCause kind : {ErrorCause::focal_length, ErrorCause::centre, ErrorCause::distortion})
      if (add({kind, camera})) lens.push_back({kind, camera});
    if (lens.size() > 1) all.push_back(lens);
    if (sums_.depend(sums_.cameras()[camera] + columnsOf(ErrorCause::shutter).first))
      add({ErrorCause::shutter, camera});
  }
  return all;
}

Eigen::Index ErrorMonitor::firstColumn(const Cause& cause) const {
  return cause.kind == ErrorCause::marker_size ? ErrorSums::kSize
                                               : sums_.cameras()[cause.camera] + columnsOf(cause.kind).first;
}

void ErrorMonitor::addErrors(const Cause& cause, ErrorPrior& prior) const {
  if (cause.kind == ErrorCause::map) return;
  const Columns columns = columnsOf(cause.kind);
  for (Eigen::Index i = 0; i < columns.count; ++i)
    prior.add({firstColumn(cause) + i}, Eigen::VectorXd::Constant(1, columns.sigma * columns.sigma));
}

ErrorPrior ErrorMonitor::priorOf(const std::vector<Cause>& causes, const Eigen::Vector2d& map_sigmas) const {
  ErrorPrior prior;
  bool has_map = false;
  for (const Cause& cause : causes) {
    has_map |= cause.kind == ErrorCause::map;
    addErrors(cause, prior);
  }
  for (const auto& [key, first] : sums_.markers()) {
    prior.add(sixFrom(first), Vector6d::Ones());
    prior.covariance.bottomRightCorner<6, 6>() = map_covariances_.at(key) + diagonal(kExactMap);
    if (has_map) prior.covariance.bottomRightCorner<6, 6>() += diagonal(map_sigmas);
  }
  return prior;
}

ErrorMonitor::Model ErrorMonitor::modelOf(const std::vector<Cause>& causes,
                                          const Eigen::Vector2d& map_sigmas) const {
  const ErrorPrior prior = priorOf(causes, map_sigmas);
  return {prior, sums_.fit(prior)};
}

// Sets the most probable of kMapSigmas, if the map is added.
double ErrorMonitor::gainOf(const Model& now, const std::vector<Cause>& added,
                            Eigen::Vector2d& map_sigmas) const {
  ErrorPrior more;
  if (added[0].kind != ErrorCause::map) {
    for (const Cause& cause : added) addErrors(cause, more);
    return sums_.gain(now.prior, now.fit, more);
  }
  double most = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& sigmas : kMapSigmas) {
    more = {};
    for (const auto& entry : sums_.markers()) more.add(sixFrom(entry.second), variancesOf(sigmas));
    const double gain = sums_.gain(now.prior, now.fit, more);
    if (gain > most) most = gain, map_sigmas = sigmas;
  }
  return most;
}

// A marker that explains the residuals clearly better than any other cause or marker, also than each accepted
// cause.
bool ErrorMonitor::findMoved() {
  if (findMoved(accepted_)) return true;
  for (size_t i = 0; i < accepted_.size(); ++i) {
    auto others = accepted_;
    others.erase(others.begin() + static_cast<long>(i));
    if (findMoved(others)) return true;
  }
  return false;
}

bool ErrorMonitor::findMoved(const std::vector<Cause>& causes) {
  const Model now = modelOf(causes, map_sigmas_);
  const auto [gain, second, moved] = mostMoved(now);
  if (gain < std::max(kMinGain, second + std::max(kMinMargin, kMinAdvantage * gain))) return false;
  for (const auto& added : candidates(causes)) {
    Eigen::Vector2d sigmas = map_sigmas_;
    if (gainOf(now, added, sigmas) < 0) continue;
    auto all = causes;
    all.insert(all.end(), added.begin(), added.end());
    const ErrorFit fit = sums_.fit(priorOf(all, sigmas), kNonlinearity * now.fit.noise);
    if (fit.log_evidence > now.fit.log_evidence + gain - kMinMargin) return false;
  }
  if (!isFarAway(now, moved)) return false;
  sums_.eliminate(moved, variancesOf(kMoved), now.fit.noise);
  moved_.insert(moved);
  return true;
}

ErrorPrior ErrorMonitor::withMoved(ErrorPrior prior, const MarkerKey& marker) const {
  prior.add(sixFrom(sums_.markers().at(marker)), variancesOf(kMoved));
  return prior;
}

// The exact evidence only of those that may have the largest one.
ErrorMonitor::MostMoved ErrorMonitor::mostMoved(const Model& now) const {
  std::vector<std::pair<double, MarkerKey>> by_gain;
  for (const auto& [key, first] : sums_.markers()) {
    if (!sums_.depend(first)) continue;
    const double gain = sums_.gain(now.prior, now.fit, withMoved({}, key));
    if (gain > 0) by_gain.emplace_back(gain, key);
  }
  const size_t exact = std::min(kExactMoved, by_gain.size());
  std::partial_sort(by_gain.begin(), by_gain.begin() + static_cast<long>(exact), by_gain.end(),
                    [](const auto& a, const auto& b) { return a.first > b.first; });
  MostMoved most{0, 0, {}};
  for (size_t i = 0; i < exact; ++i) {
    const ErrorFit fit = sums_.fit(withMoved(now.prior, by_gain[i].second), kNonlinearity * now.fit.noise);
    const double gain =
        fit.log_evidence - now.fit.log_evidence - std::log(static_cast<double>(sums_.markers().size()));
    most.second = std::max(most.second, std::min(gain, most.gain));
    if (gain > most.gain) most.gain = gain, most.marker = by_gain[i].second;
  }
  return most;
}

bool ErrorMonitor::isFarAway(const Model& now, const MarkerKey& marker) const {
  const ErrorFit fit = sums_.fit(withMoved(now.prior, marker));
  const Vector6d offset = fit.step.tail<6>(), variances = fit.covariance.diagonal().tail<6>();
  const auto is_far = [&](int i) {
    const double sigma = std::sqrt(variances.segment<3>(3 * i).maxCoeff());
    return offset.segment<3>(3 * i).norm() > std::max(kMinMoved[i], 3 * sigma);
  };
  return is_far(0) || is_far(1);
}

// Accepts the candidate with the largest evidence. Several causes are accepted together if that is larger by
// far than the best one alone; dropOne() then sorts out those that are not needed. If a marker may have been
// moved, only an inexact map is accepted.
bool ErrorMonitor::accept() {
  const Model now = modelOf(accepted_, map_sigmas_);
  double most = now.fit.log_evidence;
  std::vector<Cause> chosen;
  Eigen::Vector2d chosen_sigmas = map_sigmas_;
  const double most_misfit = (1 - kMinShare) * (sums_.count() + now.fit.penalty);
  auto all = candidates(accepted_);
  const double moved = mostMoved(now).gain;
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  for (const auto& added : all) {
    Eigen::Vector2d sigmas = map_sigmas_;
    if (gainOf(now, added, sigmas) < 0) continue;
    auto causes = accepted_;
    causes.insert(causes.end(), added.begin(), added.end());
    const ErrorFit fit = modelOf(causes, sigmas).fit;
    if (added[0].kind != ErrorCause::map && fit.log_evidence < now.fit.log_evidence + moved + kMinMargin)
      continue;
    const double required = chosen.empty() || added.size() > chosen.size() ? kMinGain : 0;
    const double misfit = sums_.count() * fit.noise / now.fit.noise + fit.penalty;
    if (fit.log_evidence < most + required || misfit > most_misfit) continue;
    most = fit.log_evidence;
    chosen = added;
    chosen_sigmas = sigmas;
  }
  map_sigmas_ = chosen_sigmas;
  accepted_.insert(accepted_.end(), chosen.begin(), chosen.end());
  return !chosen.empty();
}

// Drops the accepted cause without which the evidence is as large, if there is one: its errors are zero
// again.
bool ErrorMonitor::dropOne() {
  const Model with = modelOf(accepted_, map_sigmas_);
  double most = with.fit.log_evidence - kMaxLoss;
  std::optional<size_t> dropped;
  Model pinned;
  for (size_t i = 0; i < accepted_.size(); ++i) {
    auto others = accepted_;
    others.erase(others.begin() + static_cast<long>(i));
    const ErrorPrior prior = withZero(priorOf(others, map_sigmas_), with.prior.columns);
    const ErrorFit fit = sums_.fit(prior);
    if (fit.log_evidence < most) continue;
    most = fit.log_evidence;
    dropped = i;
    pinned = {prior, fit};
  }
  if (!dropped) return false;
  accepted_.erase(accepted_.begin() + static_cast<long>(*dropped));
  apply(pinned);
  for (const Eigen::Index column : with.prior.columns)
    if (!contains(posterior_.columns, column)) sums_.remove(column, -sums_.values()[column]);
  return true;
}

// The offsets of the markers remain zero: they are integrated out.
void ErrorMonitor::apply(const Model& model) {
  std::set<Eigen::Index> of_markers;
  for (const auto& entry : sums_.markers())
    for (const Eigen::Index column : sixFrom(entry.second)) of_markers.insert(column);
  std::vector<Eigen::Index> estimated;  // indices of the prior's columns
  for (size_t i = 0; i < model.prior.columns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (of_markers.count(model.prior.columns[i]) == 0 && model.prior.covariance(at, at) > kMinVariance)
      estimated.push_back(at);
  }
  const auto n = static_cast<Eigen::Index>(estimated.size());
  posterior_ = {{}, Eigen::MatrixXd(n, n)};
  Eigen::VectorXd step = Eigen::VectorXd::Zero(sums_.columns());
  for (Eigen::Index i = 0; i < n; ++i) {
    posterior_.columns.push_back(model.prior.columns[estimated[i]]);
    step[posterior_.columns.back()] = model.fit.step[estimated[i]];
    for (Eigen::Index j = 0; j < n; ++j)
      posterior_.covariance(i, j) = model.fit.covariance(estimated[i], estimated[j]);
  }
  sums_.remove(step);
  if (accepts(ErrorCause::map)) fitMapSigmas(model);
}

// One step of expectation maximization: the mean square of the offsets, with their uncertainty.
void ErrorMonitor::fitMapSigmas(const Model& model) {
  Eigen::Vector2d sums = Eigen::Vector2d::Zero();
  int count = 0;
  for (const auto& entry : sums_.markers()) {
    const auto& columns = model.prior.columns;
    const auto at = std::find(columns.begin(), columns.end(), entry.second) - columns.begin();
    const Vector6d squares =
        model.fit.step.segment<6>(at).cwiseAbs2() + model.fit.covariance.diagonal().segment<6>(at);
    sums += Eigen::Vector2d(squares.head<3>().sum(), squares.tail<3>().sum());
    count += 3;
  }
  if (count > 0) map_sigmas_ = (sums / count).cwiseSqrt().cwiseMax(1e-4);
}

// ---- results --------------------------------------------------------------------------------------------

std::vector<SystematicError> ErrorMonitor::errors() const {
  std::vector<SystematicError> all;
  for (const Cause& cause : accepted_) {
    if (cause.kind == ErrorCause::map) {
      all.push_back({cause.kind, 0, map_sigmas_, Eigen::VectorXd::Zero(2)});
      continue;
    }
    const Eigen::Index first = firstColumn(cause), count = columnsOf(cause.kind).count;
    SystematicError error{cause.kind, cause.camera, sums_.values().segment(first, count),
                          Eigen::VectorXd::Zero(count)};
    for (size_t i = 0; i < posterior_.columns.size(); ++i) {
      const Eigen::Index k = posterior_.columns[i] - first, at = static_cast<Eigen::Index>(i);
      if (k >= 0 && k < count) error.sigma[k] = std::sqrt(posterior_.covariance(at, at));
    }
    all.push_back(error);
  }
  return all;
}

CameraErrors ErrorMonitor::cameraErrors(size_t camera) const {
  if (camera >= sums_.cameras().size()) return {};
  return CameraErrors::fromVector(sums_.values().segment<CameraErrors::kCount>(sums_.cameras()[camera]));
}

double ErrorMonitor::sizeFactor() const {
  return sums_.columns() > 0 ? std::exp(sums_.values()[ErrorSums::kSize]) : 1.0;
}

std::set<MarkerKey> ErrorMonitor::takeMoved() {
  std::set<MarkerKey> markers;
  markers.swap(moved_);
  return markers;
}

bool ErrorMonitor::accepts(ErrorCause kind) const {
  return std::any_of(accepted_.begin(), accepted_.end(),
                     [=](const Cause& each) { return each.kind == kind; });
}

MappedMarker ErrorMonitor::corrected(const MappedMarker& marker) const {
  MappedMarker result = marker;
  result.size *= sizeFactor();
  if (accepts(ErrorCause::map)) result.covariance += diagonal(map_sigmas_);
  return result;
}

Matrix6d ErrorMonitor::poseCovariance(const std::vector<MonitoredMarker>& markers,
                                      const Matrix6d& information) const {
  const Eigen::LDLT<Matrix6d> pose(information);
  const auto n = static_cast<Eigen::Index>(posterior_.columns.size());
  Eigen::MatrixXd sensitivity = Eigen::MatrixXd::Zero(6, n);
  for (const MonitoredMarker& marker : markers) {
    const MarkerLinearization& linear = marker.linearization;
    const Eigen::Matrix<double, 6, 8> gain =
        pose.solve(linear.covariance.ldlt().solve(linear.by_base).transpose());
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index column = posterior_.columns[i];
      if (column == ErrorSums::kSize) {
        sensitivity.col(i) += gain * linear.by_size;
      } else if (marker.camera < sums_.cameras().size()) {
        const Eigen::Index k = column - sums_.cameras()[marker.camera];
        if (k >= 0 && k < CameraErrors::kCount) sensitivity.col(i) += gain * marker.by_camera.col(k);
      }
    }
  }
  return sensitivity * posterior_.covariance * sensitivity.transpose();
}

}  // namespace sextant
