// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/kidnap_detector.hpp"

#include <algorithm>
#include <iterator>

namespace sextant {
namespace {

constexpr double kMissesPerConfirmation = 3;  // that a scan which confirms the map cancels
constexpr double kMissesPerSlip = 3;          // odometry rarely slips: several slips in a row did not happen
constexpr int kMinConfirmations = 3;          // successive scans: one or two may be mistaken

}  // namespace

void KidnapDetector::update(const Evidence& evidence) {
  const auto is_established = [this](int key) { return key < first_provisional_; };
  const auto observed =
      static_cast<int>(std::count_if(evidence.observed.begin(), evidence.observed.end(), is_established));
  std::vector<int> missed;
  std::copy_if(evidence.missed.begin(), evidence.missed.end(), std::back_inserter(missed), is_established);
  updateMisses(observed, missed, evidence);
  if (!evidence.observed.empty() || evidence.unknown + evidence.contradictions > 0) is_blank_ = false;
  if (isConsistent()) forget();
  if (observed > static_cast<int>(missed.size())) {
    ++confirmations_;
  } else if (!evidence.observed.empty() || evidence.unknown > 0) {
    confirmations_ = 0;
  }
  if (first_provisional_ == 0 || confirmations_ >= kMinConfirmations) confirm(evidence.next_key);
}

void KidnapDetector::updateMisses(int observed, const std::vector<int>& missed, const Evidence& evidence) {
  // One unknown observation may be a false alarm.
  const int foreign = evidence.is_complete ? std::max(0, evidence.unknown - 1) : 0;
  const int contradicting = evidence.contradictions + foreign;
  const int contradictions = static_cast<int>(missed.size()) + contradicting;
  const int unknown = evidence.unknown + static_cast<int>(evidence.observed.size()) - observed;
  // At a wrong pose some landmarks are observed by chance: then most observations contradict a complete map.
  const bool is_contradicted =
      evidence.is_complete ? contradictions > observed : observed == 0 && contradictions > 0;
  if (evidence.slipped) {
    misses_ += kMissesPerSlip;
    contradicted_ = true;
  } else if (observed > contradictions + unknown) {
    misses_ = std::max(0.0, misses_ - kMissesPerConfirmation);
  } else if (is_contradicted) {
    misses_ +=
        contradicting > 0 ? 1.0 : std::min(1.0, evidence.miss_weight * static_cast<double>(missed.size()));
    missed_.insert(missed.begin(), missed.end());
    contradicted_ = contradicted_ || contradicting > 0;
  }
}

void KidnapDetector::forget() {
  is_blank_ = true;
  missed_.clear();
  contradicted_ = false;
}

bool KidnapDetector::isLost() const {
  return lost_after_ > 0 && misses_ >= lost_after_ && !is_blank_ && (missed_.size() >= 2 || contradicted_);
}

}  // namespace sextant
