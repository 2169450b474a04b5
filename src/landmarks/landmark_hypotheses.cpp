// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/landmark_hypotheses.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace sextant {
namespace {

using Eigen::Vector3d;

constexpr double kNegligible = -9;      // log weight at which a hypothesis is dropped
constexpr double kMostNumbers = 2.5e6;  // in the covariances of all: two hypotheses about 550 landmarks
constexpr double kEqual = 0.1;          // squared Mahalanobis distance below which two states are the same

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

}  // namespace

void LandmarkHypotheses::predict(const OdometryStep& step, double duration) {
  for (Hypothesis& each : all_) each.slam.predict(step, duration);
}

LandmarkReport LandmarkHypotheses::observe(double stamp, const std::vector<LabelledObservation>& observations,
                                           const Pose2& T_base_sensor) {
  struct Child {
    size_t parent;
    ScanInterpretation how;
    double log_weight;
  };
  const size_t most = affordable(), of_each = std::min(most, 1 + most / all_.size());
  std::vector<Child> children;
  for (size_t i = 0; i < all_.size(); ++i)
    for (ScanInterpretation& how : all_[i].slam.interpretations(observations, T_base_sensor, of_each))
      children.push_back({i, how, all_[i].log_weight + how.log_likelihood});
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
    next.back().log_weight = each.log_weight - best_weight;
    next.back().report = next.back().slam.observe(stamp, observations, T_base_sensor, each.how);
  }
  all_ = sorted(withoutEqual(withoutLost(std::move(next))));
  is_confirmed_ = is_confirmed_ || all_.front().report.associated > 0;
  return all_.front().report;
}

void LandmarkHypotheses::place(const std::vector<PossiblePose>& poses) {
  LandmarkSlam& slam = settled();
  if (!slam.isLost()) slam.relocalize();
  std::vector<Hypothesis> placed;
  for (const PossiblePose& each : poses) {
    placed.push_back({slam, std::log(each.probability), {}});
    placed.back().slam.setPose(each.T_map_base, each.covariance);
  }
  placed = sorted(std::move(placed));
  placed.erase(placed.begin() + static_cast<long>(std::min(placed.size(), affordable())), placed.end());
  all_ = std::move(placed);
  is_confirmed_ = false;
}

/// Fewer for a large map, so that time and memory stay within bounds.
size_t LandmarkHypotheses::affordable() const {
  const double size = 3 + 2 * static_cast<double>(best().labels().size());
  return static_cast<size_t>(std::clamp(kMostNumbers / (size * size), 1.0, 1.0 * best().params().hypotheses));
}

/// A lost one explains everything by a map of its own: it is only kept if all are lost.
std::vector<LandmarkHypotheses::Hypothesis> LandmarkHypotheses::withoutLost(std::vector<Hypothesis> all) {
  const auto is_lost = [](const Hypothesis& each) { return each.slam.isLost(); };
  if (!std::all_of(all.begin(), all.end(), is_lost))
    all.erase(std::remove_if(all.begin(), all.end(), is_lost), all.end());
  return all;
}

std::vector<LandmarkHypotheses::Hypothesis> LandmarkHypotheses::sorted(std::vector<Hypothesis> all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.log_weight > b.log_weight; });
  const double best_weight = all.front().log_weight;
  for (Hypothesis& each : all) each.log_weight -= best_weight;
  return all;
}

/// The weight of one that is dropped is added to that of its equal.
std::vector<LandmarkHypotheses::Hypothesis> LandmarkHypotheses::withoutEqual(std::vector<Hypothesis> all) {
  std::vector<Hypothesis> kept;
  for (Hypothesis& each : all) {
    const auto equal = std::find_if(kept.begin(), kept.end(),
                                    [&](const Hypothesis& other) { return areEqual(other.slam, each.slam); });
    if (equal == kept.end()) {
      kept.push_back(std::move(each));
    } else {
      equal->log_weight += std::log1p(std::exp(each.log_weight - equal->log_weight));
    }
  }
  return kept;
}

std::vector<double> LandmarkHypotheses::probabilities() const {
  std::vector<double> shares;
  double sum = 0;
  for (const Hypothesis& each : all_) {
    shares.push_back(std::exp(each.log_weight));
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
  for (size_t i = 1; i < all_.size(); ++i) {
    const PoseEstimate2D other = all_[i].slam.predictPose(step);
    const Vector3d off = difference(other.pose, centre);
    found.covariance += shares[i] * (other.covariance + off * off.transpose());
  }
  return found;
}

LandmarkSlam& LandmarkHypotheses::settled() {
  all_.erase(all_.begin() + 1, all_.end());
  all_.front().log_weight = 0;
  return all_.front().slam;
}

}  // namespace sextant
