// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>

namespace sextant {

/// Limits the rate of images, evenly. An image up to a quarter of the period early passes, so that jitter
/// does not cost images of a camera whose rate is the limit or a multiple of it.
class RateLimit {
 public:
  /// Clock that is not set.
  using Clock = std::chrono::steady_clock;

  /// Period of a rate in Hz; zero for no limit (0).
  static Clock::duration period(double rate);

  /// Time at which the next image is due.
  Clock::time_point due(Clock::time_point now) const { return due_.value_or(now); }

  /// Whether an image that arrives now passes. @param rate Hz, may change between calls; 0: no limit
  bool passes(Clock::time_point now, double rate);

 private:
  std::optional<Clock::time_point> due_;
};

}  // namespace sextant
