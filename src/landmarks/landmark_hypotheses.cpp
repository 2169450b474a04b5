// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_hypotheses.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace sextant {
namespace {

using Eigen::Vector3d;

constexpr double kNegligible = -9;      // log weight at which a hypothesis is dropped
constexpr double kImprobable = 1e-3;    // probability of all hypotheses that the covariance need not cover
constexpr double kMostNumbers = 2.5e6;  // in the covariances of all: two hypotheses about 550 landmarks
constexpr double kEqual = 0.1;          // squared Mahalanobis distance below which two states are the same

constexpr double kMinKnown = 0.5;      // probability that an image is of the map, for it to be used
constexpr double kMinPlace = 0.05;     // of a place that becomes a hypothesis
constexpr double kMinUnknown = 0.1;    // share of images whose answer is wrong although it looks certain
constexpr double kLogCarried = -8;     // of a hypothesis that contradicts all others
constexpr double kMostAgainst = 9;     // evidence of images against a hypothesis with landmarks
constexpr double kMoreAgainst = 0.5;   // for each metre without landmarks
constexpr double kMeasured = 2;        // metres between two corrections by places: images nearby err alike
constexpr double kLeastImage = 0.2;    // evidence of an image at the place of the last one
constexpr double kSettledPlace = 0.5;  // probability of a place that corrects the pose
constexpr double kSamePlace = 0.999;   // of the squared distance of a pose from its place

constexpr double kLogElsewhere = -3;  // density of what a wrong source shows, 1/m^2: it is somewhere in view
constexpr double kLogLost = -12;      // of a lost one, while the others take a source to be wrong

/// Whether two hypotheses have the same landmarks, at the same places, and the same pose.
bool areEqual(const LandmarkSlam& a, const LandmarkSlam& b) {
  if (a.labels() != b.labels() || a.isLost() != b.isLost()) return false;
  const LandmarkFilter &one = a.filter(), &other = b.filter();
  const Vector3d off = difference(one.pose(), other.pose());
  if (off.dot(one.covariance({}).inverse() * off) > kEqual) return false;
  for (size_t i = 0; i < one.landmarks().size(); ++i) {
    const Eigen::Vector2d apart = one.landmarks()[i].position - other.landmarks()[i].position;
    if (apart.dot(one.covariance({i}).block<2, 2>(3, 3).inverse() * apart) > kEqual) return false;
  }
  return true;
}

/// Whether a pose may be at a place.
bool isAt(const PoseEstimate2D& robot, const PossiblePose& place) {
  static const double gate = quantile(boost::math::chi_squared(3), kSamePlace);
  const Vector3d off = difference(place.T_map_base, robot.pose);
  return off.dot((place.covariance + robot.covariance).inverse() * off) < gate;
}

PoseEstimate2D poseOf(const LandmarkSlam& slam) {
  return {slam.filter().pose(), slam.filter().covariance({})};
}

/// Squared difference of two poses. Left and right are the same half turn: near it, the heading is not
/// correlated with the position.
Eigen::Matrix3d spread(const Vector3d& off) {
  const Vector3d turned = off - Vector3d(0, 0, std::copysign(2 * M_PI, off(2)));
  const double share = std::max(0.0, (std::abs(off(2)) - M_PI_2) / M_PI);
  return (1 - share) * off * off.transpose() + share * turned * turned.transpose();
}

/// Whether a scan supports the pose.
bool agrees(const ScanInterpretation& how) {
  const auto is_associated = [](const Association& each) { return each.outcome == Outcome::associated; };
  return !how.slipped && std::any_of(how.outcomes.begin(), how.outcomes.end(), is_associated);
}

/// Whether a scan shows only what is not where the map has it; markers that are not in the map do not count.
bool contradicts(const ScanInterpretation& how, const std::vector<LabelledObservation>& observations) {
  if (agrees(how)) return false;
  bool is_elsewhere = how.slipped;
  for (size_t i = 0; i < observations.size(); ++i) {
    const Outcome outcome = how.outcomes[i].outcome;
    const Outcome if_elsewhere = observations[i].label.id ? Outcome::ambiguous : Outcome::unassociated;
    is_elsewhere = is_elsewhere || outcome == if_elsewhere;
  }
  return is_elsewhere;
}

/// Whether a wrong source explains a scan better than all interpretations: they contradict the pose, or are
/// as unlikely.
bool isUnexplained(const std::vector<ScanInterpretation>& all,
                   const std::vector<LabelledObservation>& observations) {
  const auto is_likely = [](const ScanInterpretation& how) {
    return agrees(how) && how.log_likelihood > kLogElsewhere;
  };
  if (std::any_of(all.begin(), all.end(), is_likely)) return false;
  return agrees(all.front()) || contradicts(all.front(), observations);
}

}  // namespace

void LandmarkHypotheses::predict(const OdometryStep& step, double duration) {
  since_image_ += step.distance + std::abs(step.turn);
  for (Hypothesis& each : all_) {
    each.slam.predict(step, duration);
    each.unmeasured += step.distance;
    each.faults.drive(step.distance);
  }
}

LandmarkReport LandmarkHypotheses::observe(double stamp, const std::vector<LabelledObservation>& observations,
                                           const Pose2& T_base_sensor, Detects detects) {
  const Scan scan{stamp, observations, T_base_sensor, detects};
  const size_t most = affordable();
  std::vector<Child> children = childrenOf(scan, most);
  std::stable_sort(children.begin(), children.end(),
                   [](const Child& a, const Child& b) { return a.log_weight > b.log_weight; });
  const double best_weight = children.front().log_weight;
  const auto is_negligible = [&](const Child& each) { return each.log_weight - best_weight < kNegligible; };
  children.erase(std::find_if(children.begin(), children.end(), is_negligible), children.end());
  if (children.size() > most) children.erase(children.begin() + static_cast<long>(most), children.end());

  std::vector<int> left(all_.size());  // children of each that are still to be made
  for (const Child& each : children) ++left[each.parent];
  std::vector<Hypothesis> next;
  for (const Child& each : children) {
    Hypothesis& parent = all_[each.parent];
    next.push_back(--left[each.parent] > 0 ? parent : std::move(parent));
    next.back().log_weight = each.log_weight - best_weight - next.back().log_places;
    apply(scan, each, next.back());
  }
  all_ = sorted(withoutEqual(withoutLost(std::move(next))));
  return all_.front().report;
}

std::vector<LandmarkHypotheses::Child> LandmarkHypotheses::childrenOf(const Scan& scan, size_t most) {
  std::vector<Child> found;
  for (size_t i = 0; i < all_.size(); ++i) addChildren(scan, i, most, found);
  weigh(scan, found);
  return found;
}

/// Adds each interpretation of the scan, and that its source is wrong. A map that is not read-only corrects
/// itself.
void LandmarkHypotheses::addChildren(const Scan& scan, size_t parent, size_t most,
                                     std::vector<Child>& found) {
  Hypothesis& of = all_[parent];
  const PoseSource source = sourceOf(scan.detects);
  const bool is_excluded = of.faults.isExcluded(source);
  const size_t of_each = is_excluded || of.is_aside ? 1 : std::min(most, 1 + most / all_.size());
  const auto all = of.slam.interpretations(scan.observations, scan.T_base_sensor, of_each, scan.detects);
  for (const ScanInterpretation& how : all) found.push_back({parent, how, 0, !is_excluded});
  const bool is_open = of.slam.params().read_only && !is_excluded && !of.is_aside;
  if (is_open && most > 1 && of.faults.mayBeWrong(source) && isUnexplained(all, scan.observations))
    found.push_back({parent, all.front(), SourceFaults::kLogWrong, false});
}

/// A source that is taken to be wrong, and a map of a lost robot, explain a scan as well as the best of the
/// others.
void LandmarkHypotheses::weigh(const Scan& scan, std::vector<Child>& found) const {
  double best = -std::numeric_limits<double>::infinity();
  for (const Child& each : found)
    if (each.is_applied && !all_[each.parent].is_aside) best = std::max(best, each.how.log_likelihood);
  if (std::isinf(best)) best = 0;
  for (Child& each : found) {
    const Hypothesis& of = all_[each.parent];
    if (each.is_applied && !of.is_aside) {
      each.log_weight += each.how.log_likelihood;
    } else if (!each.is_applied && excludes(scan, each, of)) {
      each.log_weight += std::max(best, kLogElsewhere);
    } else {
      each.log_weight += best;
    }
    each.log_weight += of.weight();
  }
}

/// Whether a scan that is not applied shows that its source is wrong, to a hypothesis.
bool LandmarkHypotheses::excludes(const Scan& scan, const Child& child, const Hypothesis& to) {
  return !to.faults.isExcluded(sourceOf(scan.detects)) || contradicts(child.how, scan.observations);
}

/// @param to a copy of the parent
void LandmarkHypotheses::apply(const Scan& scan, const Child& child, Hypothesis& to) {
  const PoseSource source = sourceOf(scan.detects);
  if (child.is_applied) {
    to.report = to.slam.observe(scan.stamp, scan.observations, scan.T_base_sensor, child.how);
    if (to.report.associated == 0) return;
    to.is_confirmed = true, to.unmeasured = 0;
    if (to.report.associated > to.report.rejected + to.report.unexpected) to.faults.support(source);
    return;
  }
  to.report = {};
  to.report.keys.resize(scan.observations.size());
  if (excludes(scan, child, to)) {
    to.report.excluded = static_cast<int>(scan.observations.size());
    if (to.faults.isExcluded(source)) to.log_weight += to.faults.compare(source, false);
    to.faults.exclude(source);
  } else if (agrees(child.how)) {
    to.faults.compare(source, true);
  }
}

// ---- places

PlaceUse LandmarkHypotheses::observePlaces(const std::vector<PossiblePose>& poses) {
  double known = 0;
  for (const PossiblePose& each : poses) known += each.probability;
  if (known < kMinKnown) return PlaceUse::unused;
  if (best().isLost()) {
    place(poses);
    return PlaceUse::relocalized;
  }
  const Pose2 before = best().filter().pose();
  addPlaces(poses);
  const double evidence = evidenceOfImage();
  since_image_ = 0;
  for (Hypothesis& each : all_)
    if (!each.is_aside) judge(each, poses, evidence);
  boundPlaces(all_);
  const size_t most = affordable();
  all_ = likely(std::move(all_), most);
  const PoseEstimate2D now = poseOf(best());
  const bool is_at_one = std::any_of(poses.begin(), poses.end(), [&](const auto& each) {
    return each.probability >= kMinPlace && isAt(now, each);
  });
  if (is_at_one && !isAt({before, Eigen::Matrix3d::Zero()}, {now.pose, now.covariance, 1}))
    return PlaceUse::relocalized;
  return is_at_one ? PlaceUse::agrees : PlaceUse::contradicts;
}

/// 1: it is independent of earlier ones.
double LandmarkHypotheses::evidenceOfImage() const {
  const bool is_settled =
      std::any_of(all_.begin(), all_.end(), [](const Hypothesis& each) { return each.is_confirmed; });
  return is_settled ? 1 : std::clamp(since_image_ / kMeasured, kLeastImage, 1.0);
}

std::vector<PoseSource> LandmarkHypotheses::wrongSources() const {
  std::vector<PoseSource> found;
  for (const PoseSource source : {PoseSource::markers, PoseSource::landmarks, PoseSource::places})
    if (all_.front().faults.isWrong(source)) found.push_back(source);
  return found;
}

/// The map is that of the best hypothesis, without the landmarks that may have been initialized at a wrong
/// pose.
void LandmarkHypotheses::place(const std::vector<PossiblePose>& poses) {
  LandmarkSlam& slam = settled();
  std::vector<Hypothesis> placed;
  for (const PossiblePose& each : poses) {
    placed.push_back({slam, std::log(each.probability), 0, false});
    placed.back().slam.setPose(each.T_map_base, each.covariance);
  }
  all_ = likely(withoutEqual(std::move(placed)), affordable());
  since_image_ = 0;
}

/// Adds a hypothesis for each place at which none is.
void LandmarkHypotheses::addPlaces(const std::vector<PossiblePose>& poses) {
  const Hypothesis& first = all_.front();
  SourceFaults faults = first.faults;
  faults.forgetUnconfirmed();
  const double carried = weightWithoutFaults(all_) + kLogCarried;
  std::vector<Hypothesis> added;
  for (const PossiblePose& each : poses) {
    const bool is_known = std::any_of(all_.begin(), all_.end(), [&](const Hypothesis& hypothesis) {
      return !hypothesis.is_aside && isAt(poseOf(hypothesis.slam), each);
    });
    if (each.probability < kMinPlace || is_known) continue;
    added.push_back({first.slam, carried, 0, false});
    added.back().faults = faults;
    LandmarkSlam& slam = added.back().slam;
    slam.relocalize();
    slam.setPose(each.T_map_base, each.covariance);
  }
  std::move(added.begin(), added.end(), std::back_inserter(all_));
}

/// Adds the evidence of an image, and corrects the pose by the place at which it is.
/// @param evidence of the image, 1: it is independent of earlier ones
void LandmarkHypotheses::judge(Hypothesis& hypothesis, const std::vector<PossiblePose>& poses,
                               double evidence) {
  const PoseEstimate2D robot = poseOf(hypothesis.slam);
  double here = 0;
  const PossiblePose* place = nullptr;
  for (const PossiblePose& each : poses) {
    if (!isAt(robot, each)) continue;
    here += each.probability;
    if (!place || each.probability > place->probability) place = &each;
  }
  hypothesis.log_places += evidence * std::log(std::max(here, kMinUnknown));
  // Without landmarks it may be at this place because of earlier images.
  if (here >= kSettledPlace && hypothesis.is_confirmed) hypothesis.faults.support(PoseSource::places);
  if (!place || place->probability < kSettledPlace || hypothesis.unmeasured < kMeasured) return;
  hypothesis.slam.observePose({place->T_map_base, place->covariance});
  hypothesis.unmeasured = 0;
}

/// Relative to that which fits best.
void LandmarkHypotheses::boundPlaces(std::vector<Hypothesis>& all) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& each : all)
    if (!each.is_aside) most = std::max(most, each.log_places);
  for (Hypothesis& each : all) {
    each.log_places = each.is_aside ? 0 : each.log_places - most;
    if (each.is_confirmed)
      each.log_places = std::max(each.log_places, -kMostAgainst - kMoreAgainst * each.unmeasured);
  }
}

/// The most probable ones, sorted. @param most maximum number
std::vector<LandmarkHypotheses::Hypothesis> LandmarkHypotheses::likely(std::vector<Hypothesis> all,
                                                                       size_t most) {
  all = sorted(std::move(all));
  const auto end = std::find_if(all.begin() + 1, all.end(),
                                [](const Hypothesis& each) { return each.weight() < kNegligible; });
  all.erase(end, all.end());
  if (all.size() > most) all.erase(all.begin() + static_cast<long>(most), all.end());
  return all;
}

/// Fewer for a large map, so that time and memory stay within bounds.
size_t LandmarkHypotheses::affordable() const {
  const double size = 3 + 2 * static_cast<double>(best().labels().size());
  return static_cast<size_t>(std::clamp(kMostNumbers / (size * size), 1.0, 1.0 * best().params().hypotheses));
}

/// A lost one explains everything by a map of its own: it is only kept if all are lost, or if the others take
/// a source to be wrong which no other source has confirmed yet.
std::vector<LandmarkHypotheses::Hypothesis> LandmarkHypotheses::withoutLost(std::vector<Hypothesis> all) {
  const auto is_lost = [](const Hypothesis& each) { return each.slam.isLost(); };
  if (std::all_of(all.begin(), all.end(), is_lost)) {
    for (Hypothesis& each : all) each.faults = {}, each.is_aside = false;
    return all;
  }
  const auto is_certain = [&](const Hypothesis& each) {
    return !is_lost(each) && each.faults.logPrior() == 0;
  };
  if (std::any_of(all.begin(), all.end(), is_certain))
    all.erase(std::remove_if(all.begin(), all.end(), is_lost), all.end());
  return setAside(std::move(all));
}

/// That of a hypothesis which explains the scans of all sources as well.
double LandmarkHypotheses::weightWithoutFaults(const std::vector<Hypothesis>& all) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Hypothesis& each : all)
    if (!each.slam.isLost()) most = std::max(most, each.weight() - each.faults.logPrior());
  return most;
}

/// Weighs those that have become lost, and those that have just been relocalized.
std::vector<LandmarkHypotheses::Hypothesis> LandmarkHypotheses::setAside(std::vector<Hypothesis> all) {
  const double reference = weightWithoutFaults(all);
  for (Hypothesis& each : all) {
    if (each.slam.isLost() == each.is_aside) continue;
    each.is_aside = !each.is_aside;
    if (each.is_aside) {
      each.log_places = 0;
      each.log_weight = reference + kLogLost;
    } else {
      each.log_weight += kLogCarried - kLogLost;
    }
  }
  return all;
}

std::vector<LandmarkHypotheses::Hypothesis> LandmarkHypotheses::sorted(std::vector<Hypothesis> all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.weight() > b.weight(); });
  const double best_weight = all.front().weight();
  for (Hypothesis& each : all) each.log_weight -= best_weight;
  return all;
}

/// The weight of one that is dropped is added to that of its equal.
std::vector<LandmarkHypotheses::Hypothesis> LandmarkHypotheses::withoutEqual(std::vector<Hypothesis> all) {
  std::vector<Hypothesis> kept;
  for (Hypothesis& each : all) {
    const auto equal = std::find_if(kept.begin(), kept.end(), [&](const Hypothesis& other) {
      return other.faults == each.faults && areEqual(other.slam, each.slam);
    });
    if (equal == kept.end()) {
      kept.push_back(std::move(each));
    } else {
      equal->log_weight += std::log1p(std::exp(each.weight() - equal->weight()));
      equal->is_confirmed = equal->is_confirmed || each.is_confirmed;
    }
  }
  return kept;
}

std::vector<double> LandmarkHypotheses::probabilities() const {
  std::vector<double> shares;
  double sum = 0;
  for (const Hypothesis& each : all_) {
    const bool has_pose = !each.is_aside || best().isLost();
    shares.push_back(has_pose ? std::exp(each.weight()) : 0);
    sum += shares.back();
  }
  for (double& each : shares) each /= sum;
  return shares;
}

double LandmarkHypotheses::probability() const { return probabilities().front(); }

PoseEstimate2D LandmarkHypotheses::predictPose(const OdometryStep& step) const {
  const std::vector<double> shares = probabilities();
  PoseEstimate2D found = best().predictPose(step);
  const Pose2 centre = found.pose;
  found.covariance *= shares.front();
  double improbable = 0;
  for (size_t i = all_.size() - 1; i > 0; --i) {
    improbable += shares[i];
    if (improbable < kImprobable) continue;
    const PoseEstimate2D other = all_[i].slam.predictPose(step);
    found.covariance += shares[i] * (other.covariance + spread(difference(other.pose, centre)));
  }
  return found;
}

LandmarkSlam& LandmarkHypotheses::settled() {
  all_.erase(all_.begin() + 1, all_.end());
  Hypothesis& only = all_.front();
  only.log_weight = -only.log_places;
  only.faults = {};
  only.is_aside = false;
  return only.slam;
}

}  // namespace sextant
