// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/source_faults.hpp"

#include <algorithm>

namespace sextant {
namespace {

constexpr double kRecent = 15;            // metres within which another source must have supported the pose
constexpr double kLogUnconfirmed = -0.1;  // of each of its scans while no other source supports the pose
constexpr int kScan = 1, kImage = 3;      // confirmations: images are rarer
constexpr int kConfirmed = 8;             // confirmations after which an exclusion is certain
constexpr int kAgreeing = 10;             // scans in a row after which a source is used again

}  // namespace

PoseSource sourceOf(Detects detects) {
  return detects == Detects::with_id ? PoseSource::markers : PoseSource::landmarks;
}

bool SourceFaults::mayBeWrong(PoseSource source) const {
  return std::any_of(states_.begin(), states_.end(), [&](const State& other) {
    return &other != &of(source) && !other.is_excluded && other.unsupported < kRecent;
  });
}

void SourceFaults::exclude(PoseSource source) {
  if (!isExcluded(source)) of(source) = {of(source).unsupported, true, 0, 0, kLogWrong};
}

void SourceFaults::support(PoseSource source) {
  of(source).unsupported = 0;
  for (State& other : states_) {
    if (&other == &of(source) || !other.is_excluded) continue;
    other.confirmations += source == PoseSource::places ? kImage : kScan;
    if (other.confirmations >= kConfirmed) other.log_prior = 0;
  }
}

double SourceFaults::compare(PoseSource source, bool agrees) {
  State& state = of(source);
  state.agreeing = agrees ? state.agreeing + 1 : 0;
  if (state.agreeing >= kAgreeing) state = State(), state.unsupported = 0;
  if (agrees || state.log_prior == 0) return 0;
  state.log_prior += kLogUnconfirmed;
  return kLogUnconfirmed;
}

void SourceFaults::drive(double distance) {
  for (State& each : states_) each.unsupported += distance;
  for (const PoseSource source : {PoseSource::markers, PoseSource::landmarks, PoseSource::places})
    if (isExcluded(source) && !mayBeWrong(source)) of(source) = State();
}

double SourceFaults::logPrior() const {
  double sum = 0;
  for (const State& each : states_) sum += each.log_prior;
  return sum;
}

void SourceFaults::forgetUnconfirmed() {
  for (State& each : states_)
    if (each.log_prior < 0) each = {};
}

bool SourceFaults::operator==(const SourceFaults& other) const {
  return std::equal(states_.begin(), states_.end(), other.states_.begin(),
                    [](const State& a, const State& b) { return a.is_excluded == b.is_excluded; });
}

}  // namespace sextant
