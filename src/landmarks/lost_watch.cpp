// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/lost_watch.hpp"

#include <algorithm>
#include <iterator>

namespace sextant {
namespace {

constexpr int kTrust = 3;  // misses that a look makes up for at which more is where it should be than is not
constexpr int kBonds = 3;  // looks in a row: one or two may be mistaken

}  // namespace

void LostWatch::look(const Look& look) {
  const auto is_old = [this](int key) { return key < first_loose_; };
  const auto seen = static_cast<int>(std::count_if(look.seen.begin(), look.seen.end(), is_old));
  std::vector<int> missed;
  std::copy_if(look.missed.begin(), look.missed.end(), std::back_inserter(missed), is_old);
  weigh(seen, missed, look);
  if (seen > static_cast<int>(missed.size())) {
    ++bonds_;
  } else if (!look.seen.empty() || look.unknown > 0) {
    bonds_ = 0;
  }
  if (first_loose_ == 0 || bonds_ >= kBonds) join(look.next_key);
}

void LostWatch::weigh(int seen, const std::vector<int>& missed, const Look& look) {
  const int contradictions = static_cast<int>(missed.size()) + look.strangers;
  const int unknown = look.unknown + static_cast<int>(look.seen.size()) - seen;
  if (seen > contradictions + unknown) {
    misses_ = std::max(0, misses_ - kTrust);
  } else if (seen == 0 && contradictions > 0) {
    ++misses_;
    missed_.insert(missed.begin(), missed.end());
    strangers_ = strangers_ || look.strangers > 0;
  }
  if (!isCalm()) return;
  missed_.clear();
  strangers_ = false;
}

bool LostWatch::isLost() const {
  return lost_after_ > 0 && misses_ >= lost_after_ && (missed_.size() >= 2 || strangers_);
}

}  // namespace sextant
