// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/rate_limit.hpp"

#include <algorithm>

namespace sextant {

RateLimit::Clock::duration RateLimit::period(double rate) {
  if (rate <= 0) return Clock::duration::zero();
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate));
}

bool RateLimit::passes(Clock::time_point now, double rate) {
  const Clock::duration between = period(rate);
  const Clock::duration early = between / 4;
  due_ = std::min(due(now), now + between + early);  // the rate may have risen
  if (now < *due_ - early) return false;
  due_ = std::max(*due_, now - between) + between;
  return true;
}

}  // namespace sextant
