// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/stage_clock.hpp"

#include <algorithm>

namespace sextant {

void StageClock::start() { begin_ = std::chrono::steady_clock::now(); }

void StageClock::finish(const char* name) {
  const auto now = std::chrono::steady_clock::now();
  const double ms = std::chrono::duration<double, std::milli>(now - begin_).count();
  begin_ = now;
  const std::lock_guard<std::mutex> lock(mutex_);
  auto stage =
      std::find_if(stages_.begin(), stages_.end(), [&](const Stage& other) { return other.name == name; });
  if (stage == stages_.end()) stage = stages_.insert(stages_.end(), Stage{name});
  ++stage->runs;
  stage->sum += ms;
  stage->longest = std::max(stage->longest, ms);
}

void StageClock::fill(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (Stage& stage : stages_) {
    if (stage.runs == 0) continue;
    status.addf(stage.name + ": mean ms", "%.3f", stage.sum / stage.runs);
    status.addf(stage.name + ": max ms", "%.3f", stage.longest);
    status.addf(stage.name + ": runs", "%d", stage.runs);
    stage = Stage{stage.name};
  }
}

}  // namespace sextant
