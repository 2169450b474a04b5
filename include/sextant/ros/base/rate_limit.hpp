// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>

namespace sextant {

/// Lets so many of a camera's images a second pass, evenly: one that comes a little early for its turn
/// passes, so that a camera of just that rate, or of thrice, loses none to its jitter.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// Of a rate in Hz; 0 of none.
  static Clock::duration period(double rate);

  /// When the next one is due, if not at once.
  Clock::time_point due(Clock::time_point now) const { return due_.value_or(now); }

  /// Whether one that comes now is taken. @param rate Hz, which may change; 0: all are
  bool passes(Clock::time_point now, double rate);

 private:
  std::optional<Clock::time_point> due_;
};

}  // namespace sextant
